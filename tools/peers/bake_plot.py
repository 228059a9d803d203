"""Draws error against processor time: `bake_plot.py OUT.svg`, with the figures as JSON on standard input."""

from __future__ import annotations

import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter  # noqa: E402


def main() -> None:
    data = json.load(sys.stdin)
    figure, axes = plt.subplots(figsize=(7, 4.5))
    seconds, errors = zip(*data["ours"])
    axes.plot(seconds, [100 * error for error in errors], marker="o", label="ivg-bake, photons")
    for sampler, (cpu, error) in data["mitsuba"].items():
        # The square-root law through what was measured.
        factors = (1 / 4, 1, 4, 16)
        line = axes.plot(
            [cpu * f for f in factors], [100 * error / f**0.5 for f in factors], linestyle="--"
        )[0]
        axes.plot([cpu], [100 * error], marker="s", color=line.get_color(), label=f"Mitsuba 3, {sampler}")
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("processor time, whole grid [s]")
    axes.set_ylabel("relative RMSE of I_d.d [%]")
    axes.set_title("cornell_bunny, 16 x 16 x 16")
    axes.grid(visible=True, which="both", alpha=0.3)
    axes.legend()
    figure.tight_layout()
    figure.savefig(sys.argv[1])


if __name__ == "__main__":
    main()
