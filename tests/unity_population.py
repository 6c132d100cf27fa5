"""The population of the Unity package's sample: 200 requests, one a line.

    python unity_population.py           prints them
    python unity_population.py --write   writes the file of the sample

No survey's rows go in: a stature is drawn from a normal distribution of its sex, whose mean is that of adults world-wide
(NCD Risk Factor Collaboration, eLife 2016: 1.59 m of women, 1.71 m of men) and whose deviation is 0.07 m, within three of
them, and all other measures are left to the model, which draws them beside it.
"""

import json
import random
import sys
from pathlib import Path

FILE = Path(__file__).resolve().parent.parent / "unity_plugin/Samples~/Crowd/population.jsonl.txt"
MEAN = {"female": 1.59, "male": 1.71}
DEVIATION = 0.07
COUNT = 200


def population():
    draw = random.Random(200)
    for seed in range(1, COUNT + 1):
        sex = "female" if seed % 2 else "male"
        # Twelve uniform numbers: the same on every machine and version, which a library's normal numbers are not.
        z = max(-3.0, min(3.0, sum(draw.random() for _ in range(12)) - 6.0))
        height = round(MEAN[sex] + DEVIATION * z, 3)
        yield json.dumps({"sex": sex, "measures": {"height": height}, "seed": seed, "fill": "sample"})


if __name__ == "__main__":
    text = "\n".join(population()) + "\n"
    if sys.argv[1:] == ["--write"]:
        FILE.write_text(text, "utf-8", newline="\n")
    else:
        sys.stdout.write(text)
