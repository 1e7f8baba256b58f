"""The longest path through one period, from the linked image: see docs/step-bound.md.

| step | where |
|---|---|
| what an instruction does to the flow of control, and its class in the cycle tables | `instruction` |
| the image: instructions, symbols, bytes, places in the source | `image` |
| blocks and edges of each function that the step reaches | `flow` |
| loops by dominators | `loops` |
| what the code cannot say: how often a loop turns, what is never reached | `facts` |
| the greatest sum over all flows that the facts allow | `program` |
| instructions and cycles of a block | `cost` |
| the periods of a run in the emulator, edge by edge | `counted` |
"""


class Refused(Exception):
    """The bound does not exist, and why, by name and place."""
