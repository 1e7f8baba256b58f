"""Tables between two comments of a page, `<!-- table: NAME -->` and `<!-- table: end -->`, which a script fills."""

import re

PLACE = re.compile(r"<!-- table: (\S+) -->\n(.*?)<!-- table: end -->", re.S)


def filled(page, tables):
    """The page's text with each of these tables, by its name, in its place; other places stay."""

    def anew(place):
        name, old = place.groups()
        return f"<!-- table: {name} -->\n{tables.get(name, old)}<!-- table: end -->"

    return PLACE.sub(anew, page)


def names(page):
    return [place[1] for place in PLACE.finditer(page)]


def rows(header, lines, numbers=0):
    """A table of Markdown, whose last columns hold numbers."""
    rule = "|".join(["---"] * (len(header) - numbers) + ["---:"] * numbers)
    first, *others = (f"| {' | '.join(map(str, cells))} |\n" for cells in [header, *lines])
    return "".join([first, f"|{rule}|\n", *others])
