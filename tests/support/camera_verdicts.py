"""The table of what measuring and fitting made of random cameras, and the worst of them."""

from __future__ import annotations

import numpy as np


def share(good, of):
    """A share in words, with how many it is of."""
    return f"{100 * good / of:6.2f} % of {of}" if of else "none"


def _of(values, limit):
    values = np.abs(np.asarray(values, float))
    return share(int((values <= limit).sum()), values.size)


def _with(values, key):
    return sum(key in one for one in values)


def fit_pulls(rows):
    """Pulls of every fitted parameter that was given, with its case and name."""
    return [
        (row["case"], name, one["pull"], one)
        for row in rows
        for name, one in ((row.get("fit") or {}).get("parameters") or {}).items()
        if one is not None
    ]


def table(rows):
    """One line for each thing that is judged."""
    faults = [row for row in rows if "fault" in row]
    rows = [row for row in rows if "fault" not in row]
    with_edges = [row for row in rows if row["usable"]]
    without = [row for row in rows if row["kind"] in NO_EDGE]
    single = [pull for row in rows for edge in row["edges"] for pull in edge["pulls"]]
    pooled = [pull for row in rows for one in row["pooled"] for pull in one["pulls"]]
    noises = [row["noise"] for row in rows]
    sigma = [one["sigma"] - 1 for one in noises if "sigma" in one]
    gain = [one["gain"] - 1 for one in noises if "gain" in one]
    pulls = [pull for _, _, pull, _ in fit_pulls(rows)]
    fits = [row["fit"] for row in rows if row.get("fit")]
    unsaid = sum(one is None for fit in fits for one in (fit.get("parameters") or {}).values())
    seen = sum(bool(row["used"]) for row in with_edges)
    none = sum(not row["used"] for row in without)

    def noise_pulls(key):
        return [one[key] for one in noises if key in one]

    lines = [
        ("cameras", f"{len(rows)}, faults {len(faults)}"),
        ("edges used where there are any", share(seen, len(with_edges))),
        ("scenes without edge, none used", share(none, len(without))),
        ("edges used", str(sum(row["used"] for row in rows))),
        ("MTF of one edge within 3 errors", _of(single, 3)),
        ("MTF of one edge within 1 error", _of(single, 1)),
        ("pooled MTF within 3 errors", _of(pooled, 3)),
        ("pooled MTF within 1 error", _of(pooled, 1)),
        ("median error at 0.25 cyc/sample", _median(rows)),
        ("noise given", share(len(sigma), len(rows))),
        ("noise within 3 %", _of(sigma, 0.03)),
        ("noise within 3 errors", _of(noise_pulls("pull"), 3)),
        ("gain given", share(len(gain), len(rows))),
        ("gain within 5 %", _of(gain, 0.05)),
        ("gain within 3 errors", _of(noise_pulls("gain_pull"), 3)),
        ("read noise within 3 errors", _of(noise_pulls("read_pull"), 3)),
        ("fits", f"{len(fits)}, refused {_with(fits, 'refused')}, faults {_with(fits, 'fault')}"),
        ("parameters given, not given", f"{len(pulls)}, {unsaid}"),
        ("parameters within 3 errors", _of(pulls, 3)),
        ("parameters within 1 error", _of(pulls, 1)),
        ("seconds of a measurement", _mean(rows, "measure_s")),
        ("seconds of a fit", _mean(rows, "fit_s")),
    ]
    width = max(len(name) for name, _ in lines)
    text = "\n".join(f"{name:<{width}}  {value}" for name, value in lines)
    faults += [
        {"case": row["case"], "fault": row["fit"]["fault"]}
        for row in rows
        if "fault" in (row.get("fit") or {})
    ]
    return text + "".join(f"\nFAULT case {row['case']}: {row['fault']}" for row in faults)


NO_EDGE = frozenset(
    ("discs", "texture", "points", "flat", "clouds", "ripples", "ellipses", "blobs")
)


def _median(rows):
    texts = []
    for name, key in (("edge", "edges"), ("pooled", "pooled")):
        values = [one["sigma"] for row in rows for one in row[key]]
        if values:
            texts.append(f"{name} {np.median(values):.4f}")
    return "; ".join(texts)


def _mean(rows, key):
    values = [row[key] for row in rows if key in row]
    return f"mean {np.mean(values):.2f}, most {max(values):.2f}" if values else "none"


def worst(rows, most=10):
    """The worst cases of each kind, with what to repeat them by."""
    rows = [row for row in rows if "fault" not in row]
    missed = [
        f"case {row['case']} {row['kind']}: no edge of {row['usable']}: "
        + "; ".join(row["reasons"])[:150]
        for row in rows
        if row["usable"] and not row["used"]
    ]
    lines = missed[:most] + _worst_curves(rows, "edges", most) + _worst_curves(rows, "pooled", most)
    for key, name, limit in (("sigma", "noise", 0.03), ("gain", "gain", 0.05)):
        off = [row for row in rows if abs(row["noise"].get(key, 1) - 1) > limit]
        off.sort(key=lambda row: -abs(row["noise"][key] - 1))
        lines += [
            f"case {row['case']} {row['kind']}: {name} {row['noise'][key]:.3f} of the truth "
            f"({row['camera']['bits']} bits, true sigma {row['noise'].get('dn', 0):.2f} DN)"
            for row in off[:most]
        ]
    fits = sorted(fit_pulls(rows), key=lambda entry: -abs(entry[2]))
    lines += [
        f"case {number}: fit {name} pull {pull:+.1f}, {one['ratio']:.3f} of the truth"
        for number, name, pull, one in fits[:most]
        if abs(pull) > 2.5
    ]
    return "\n".join(lines)


def _worst_curves(rows, key, most):
    curves = [(float(np.abs(one["pulls"]).max()), row, one) for row in rows for one in row[key]]
    curves.sort(key=lambda entry: -entry[0])
    lines = []
    for pull, row, one in curves[:most]:
        if pull > 3:
            at = int(np.argmax(np.abs(one["pulls"])))
            place = (
                f"x {one['x']:.0f} y {one['y']:.0f} angle {one['angle_deg']:.1f} "
                f"length {one['length']:.0f} reach {one['reach']:.1f}"
                if "x" in one
                else f"axis {one['axis']}, {one['edges']} edges"
            )
            lines.append(
                f"case {row['case']} {row['kind']} {key}: pull {one['pulls'][at]:+.1f} at "
                f"{(at + 1) / 64:.3f}, off {one['off']:.3f}, {place}"
            )
    return lines
