"""What was measured, as Markdown tables."""

import statistics


def line(cells):
    """Return a row of a table."""
    return "| " + " | ".join(cells) + " |"


def head(cells):
    """Return the first two rows of a table: text to the left in the first column, numbers to the right."""
    return line(cells) + "\n" + line(["---"] + ["---:"] * (len(cells) - 1))


def engines_table(records):
    """Return what each engine holds and how long it took to make it."""
    rows = [head(["engine", "version", "build, s", "bytes a triangle"])]
    for r in records:
        size = "-" if r["bytes_per_triangle"] is None else f"{r['bytes_per_triangle']:.0f}"
        rows.append(line([r["engine"], r["version"], f"{r['build_seconds']:.3f}", size]))
    return "\n".join(rows)


class SpeedTable:
    """Mrays/s of each engine, and then how many times as fast as each of the others raywright is.

    `engines` are those besides raywright. The last column is raywright against itself on the fewest threads
    that were asked for; where those are the same it says 1, but for noise.
    """

    def __init__(self, engines, fewest):
        self.engines, self.fewest = engines, fewest

    def head(self):
        """Return the head of the table."""
        names = [e.name for e in self.engines]
        ratios = [*names, "fastest peer", f"raywright, {counted(self.fewest, 'thread')}"]
        return head(["Mrays/s", "hit", "raywright", *names, *(f"ratio to {name}" for name in ratios)])

    def row(self, name, records):
        """Return the row of one set of rays."""
        found = {e.name: fastest(r for r in records if r["engine"] == e.name) for e in self.engines}
        peers = [found[e.name]["ratio"] for e in self.engines if e.package != "raywright"]
        own = statistics.median(s for r in records for s in r["raywright_seconds"])
        return line(
            [
                name,
                f"{100 * records[0]['hit']:.0f} %",
                f"{records[0]['count'] / own / 1e6:.1f}",
                *(f"{r['mrays_per_second']:.1f} {r['mode']}".strip() for r in found.values()),
                *(f"{r['ratio']:.2f}" for r in found.values()),
                f"{min(peers):.2f}" if peers else "-",
                f"{fastest(r for r in records if r['engine'] == 'raywright')['ratio']:.2f}",
            ]
        )


def disagreements_table(records):
    """Return the rays, per million, on which each engine differs from raywright; the worst of its modes."""
    engines = list(dict.fromkeys(r["engine"] for r in records))
    rows = [head(["disagree, per million", *engines])]
    for name in dict.fromkeys(r["rays"] for r in records):
        of = [r for r in records if r["rays"] == name]
        worst = (max(r["disagree_per_million"] for r in of if r["engine"] == e) for e in engines)
        rows.append(line([name, *(f"{w:.0f}" for w in worst)]))
    return "\n".join(rows)


def fastest(records):
    """Return the record of the mode that is fastest beside raywright."""
    return min(records, key=lambda r: r["ratio"])


def counted(count, name):
    """Return "1 thread", "2 threads"."""
    return f"{count} {name}{'' if count == 1 else 's'}"
