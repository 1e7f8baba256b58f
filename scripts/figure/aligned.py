"""Which printed line, or word, stands where another was shown, around the places that the author has left out."""

import difflib
import re

GAP = "…"  # any number of lines or words
ALONE = 0.5  # what a line costs that only one side has
LEAST_ALIKE = 0.5
NUMBER = re.compile(r"0x[0-9a-f]+|\d+(?:[.,:]\d+)*(?:e[+-]?\d+)?")


class Unaligned(Exception):
    """A shown line or word has no printed one in its place."""


def aligned(shown, printed, cost):
    """Pairs of a shown and a printed item; None stands for an item that only the other side has.

    Of all ways to go through both in order, the one of the least cost is taken, and of several such ways the one that finds the shown
    items soonest. A gap stands for any printed items, which cost nothing and are in no pair. `cost` is that of a pair, from 0 for the same
    to infinity. Where something is left out, a shown item without a printed one may as well be there: that is `Unaligned`.
    """
    rest = costs(shown, printed, cost)
    pairs, i, j = [], 0, 0
    while i < len(shown) or j < len(printed):
        here = rest[i][j]
        if i < len(shown) and shown[i] == GAP:
            if here == rest[i + 1][j]:
                pairs.append((GAP, None))
                i += 1
            else:
                j += 1
        elif i < len(shown) and j < len(printed) and here == cost(shown[i], printed[j]) + rest[i + 1][j + 1]:
            pairs.append((shown[i], printed[j]))
            i, j = i + 1, j + 1
        elif j < len(printed) and here == ALONE + rest[i][j + 1]:
            pairs.append((None, printed[j]))
            j += 1
        else:
            if GAP in shown:
                raise Unaligned(shown[i])
            pairs.append((shown[i], None))
            i += 1
    return pairs


def costs(shown, printed, cost):
    """The least cost of what follows each place in both, at [shown][printed]."""
    rest = [[float("inf")] * (len(printed) + 1) for _ in range(len(shown) + 1)]
    for i in range(len(shown), -1, -1):
        for j in range(len(printed), -1, -1):
            ways = [0.0] if i == len(shown) and j == len(printed) else []
            if i < len(shown) and shown[i] == GAP:
                ways.append(rest[i + 1][j])
                ways += [rest[i][j + 1]] if j < len(printed) else []
            else:
                ways += [ALONE + rest[i + 1][j]] if i < len(shown) else []
                ways += [ALONE + rest[i][j + 1]] if j < len(printed) else []
                if i < len(shown) and j < len(printed):
                    ways.append(cost(shown[i], printed[j]) + rest[i + 1][j + 1])
            rest[i][j] = min(ways)
    return rest


def is_shown(shown, printed):
    """Whether a printed line, or word, is the shown one, whose `…` stand for anything. Beside a `…` blanks do not count."""
    if GAP not in shown:
        return shown == printed
    parts = [r"\s+".join(re.escape(word) for word in part.split()) for part in shown.split(GAP)]
    return re.fullmatch(r"\s*" + r".*".join(parts) + r"\s*", printed) is not None


def shape(word):
    """A word with its numbers masked; the digits of a name, as I4F28, stay."""
    return word if re.match(r"\W*[A-Za-z]\w*\d", word) else NUMBER.sub("#", word)


def line_cost(shown, printed):
    """0 for the same line, more the fewer words are the same or differ in their numbers alone, infinity for another line."""
    if is_shown(shown, printed):
        return 0.0
    ours, theirs = shown.replace(GAP, " ").split(), printed.split()
    if not ours or not theirs:
        return float("inf")
    # The words that an author leaves out say nothing against a line.
    whole = len(ours) if GAP in shown else (len(ours) + len(theirs)) / 2
    alike = (common(ours, theirs) + common([shape(word) for word in ours], [shape(word) for word in theirs])) / 2 / whole
    return 1 - alike if alike >= LEAST_ALIKE else float("inf")


def common(ours, theirs):
    """How many words are the same, in order."""
    return sum(block.size for block in difflib.SequenceMatcher(None, ours, theirs, autojunk=False).get_matching_blocks())


def word_cost(shown, printed):
    if is_shown(shown, printed):
        return 0.0
    if GAP in shown or shape(shown) != shape(printed):
        return float("inf")
    # 1.3e-7 rather stands for 1.4e-7 than 64 does.
    return 0.25 if re.sub(r"\d+", "", shown) == re.sub(r"\d+", "", printed) else 0.4


def renewed_line(shown, printed):
    """The shown line with the words that are printed now: what is left out stays left out."""
    if is_shown(shown, printed):
        return shown
    if GAP not in shown:
        return printed
    # A `…` between blanks stands for words, one within a word for a part of it.
    words = shown.split()
    try:
        pairs = aligned(words, printed.split(), word_cost)
    except Unaligned:
        raise Unaligned(shown) from None
    if len(pairs) != len(words) or any(None in pair for pair in pairs if pair[0] != GAP):
        raise Unaligned(shown)
    now = iter(old if old == GAP or is_shown(old, new) else new for old, new in pairs)
    return re.sub(r"\S+", lambda _: next(now), shown)
