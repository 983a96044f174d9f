"""The page of the pairs: its text, and the differences of pairs from a page that was read."""

import collections
import re

from rows import ACTIONS, INPUTS, MODES, THINGS, VIEWS

KINDS = (("input", INPUTS), ("thing", THINGS), ("mode", MODES), ("view", VIEWS), ("action", ACTIONS))
WORKS, FAILS, REFUSED, NONE, UNTRIED = "yes", "FAILS", "refused: ", "none: ", "not tried"
HEAD = """# All features in pairs

`tests/matrix/matrix.py --all --write docs/matrix.md` makes this page. It goes over all pairs of the list in
`tests/matrix/rows.py`: a pair works (yes), is refused (no) by the line below its table, or does not exist (–), for the reason
there. Two of the same kind stand in one row and one column, once. Actions follow each other in the random sequences of
[scripts/kill-test](reliability.md#interleaved-edits-and-deaths).

"""


def tables():
    """(title, kind and rows, kind and columns)"""
    for i, (kind, rows) in enumerate(KINDS):
        for other, columns in KINDS[i:]:
            if kind != "action":  # sequences
                yield f"{kind.capitalize()}s and {other}s", kind, rows, other, columns


def pairs(kind, rows, other, columns):
    for at, row in enumerate(rows):
        for column in columns[at + 1:] if other == kind else columns:
            yield (kind, row.name), (other, column.name)


def outcome_of(cells, a, b):
    return cells.get((a, b), cells.get((b, a)))


def reason_of(outcome):
    """A refusal without the names of the pair, or why there is none."""
    return re.sub(r"'[^']*'", "'…'", outcome.removeprefix(REFUSED).removeprefix(NONE).removeprefix("error: "))


def page(cells):
    lines, counts = [], collections.Counter()
    for title, kind, rows, other, columns in tables():
        reasons, shown = {}, columns[1:] if kind == other else columns
        lines += [f"## {title}", "", "| | " + " | ".join(column.name for column in shown) + " |", "|" + "---|" * (len(shown) + 1)]
        own = set(pairs(kind, rows, other, columns))
        for row in rows[:-1] if kind == other else rows:
            texts = []
            for column in shown:
                a, b = (kind, row.name), (other, column.name)
                outcome = outcome_of(cells, a, b) if (a, b) in own else ""
                sort = next((sort for sort in (REFUSED, NONE) if outcome and outcome.startswith(sort)), outcome)
                if (a, b) in own:
                    counts[sort or UNTRIED] += 1
                if sort in (REFUSED, NONE):
                    number = reasons.setdefault(reason_of(outcome), len(reasons) + 1)
                    outcome = f"{'no' if sort == REFUSED else '–'} ({number})"
                texts.append(UNTRIED if outcome is None else outcome)
            lines.append(f"| {row.name} | " + " | ".join(texts) + " |")
        lines += ["", *(f"{number}. `{reason}`" for reason, number in reasons.items()), *[""] * bool(reasons)]
    total = counts[WORKS] + counts[REFUSED] + counts[FAILS]
    numbers = (f"{total} pairs: {counts[WORKS]} work, {counts[REFUSED]} are refused, {counts[FAILS]} fail; {counts[NONE]} more do "
               f"not exist" + (f", {counts[UNTRIED]} are not tried yet" if counts[UNTRIED] else "") + ".\n\n")
    return HEAD + numbers + "\n".join(lines).rstrip("\n") + "\n"


def read_page(text):
    """The cells of a page; a refusal and a pair that does not exist have their reason."""
    cells = {}
    for title, kind, _, other, _ in tables():
        block = text.partition(f"\n## {title}\n")[2].partition("\n## ")[0]
        table = [[cell.strip() for cell in line.strip("|").split("|")] for line in block.splitlines() if line.startswith("|")]
        reasons = dict(re.findall(r"^(\d+)\. `(.*)`$", block, re.MULTILINE))
        for row in table[2:]:
            for column, cell in zip(table[0][1:], row[1:]):
                number = re.fullmatch(r"(no|–) \((\d+)\)", cell)
                cells[(kind, row[0]), (other, column)] = \
                    (REFUSED if number[1] == "no" else NONE) + reasons[number[2]] if number else cell
    return cells


def tried(text):
    """The cells of a page that say more than that a pair was not tried."""
    return {pair: cell for pair, cell in read_page(text).items() if cell.startswith((WORKS, REFUSED, NONE))}


def differences(cells, text):
    """The pairs of rows that the page lacks, and those that it has otherwise."""
    shown = read_page(text)
    for _, kind, rows, other, columns in tables():
        for pair in pairs(kind, rows, other, columns):
            found, there = outcome_of(cells, *pair), shown.get(pair, "")
            if found and found.startswith((REFUSED, NONE)):
                found = found.partition(": ")[0] + ": " + reason_of(found)
            if found is None and there == UNTRIED:
                continue
            if (found or there) != there or not there.startswith((WORKS, REFUSED, NONE)):
                yield f"{' '.join(pair[0])} x {' '.join(pair[1])}: the page has '{there}', found '{found or 'no trial'}'"
