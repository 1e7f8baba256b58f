/* What a board must do for this example: print a line, and stop. */
#ifndef BOARD_H
#define BOARD_H

/** Prints a text. */
void print(const char *text);

/** Runs main() and stops the emulator with its result. */
void run_main(void);

#endif
