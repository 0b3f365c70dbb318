#!/usr/bin/env python3
"""Measured tables in the READMEs, made anew: `./run study`.

A table stands between <!-- measured: SCENE IN --> and <!-- end -->, paths from the repository's root,
and comes from `brume study SCENE IN --table`. The chart of the root README is data/study.svg.
"""
import glob
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BLOCK = re.compile(r"(<!-- measured: (\S+) (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)
CHART = ("data/scenes/fog.toml", "data/valley_hero_1920x1080.exr", "data/study.svg")


def main():
    brume = os.path.abspath(sys.argv[1])
    os.chdir(ROOT)
    made = {}
    with tempfile.TemporaryDirectory() as temp:
        def table(scene, frame):
            if (scene, frame) not in made:
                out = os.path.join(temp, f"{len(made)}.md")
                command = [brume, "study", scene, frame, "--table", out]
                if (scene, frame) == CHART[:2]:
                    command += ["--chart", CHART[2], "--overwrite"]
                subprocess.run(command, check=True)
                with open(out, encoding="utf-8") as f:
                    made[scene, frame] = f.read()
            return made[scene, frame]

        table(*CHART[:2])
        for path in sorted(glob.glob("plugins/*/README.md")):
            with open(path, encoding="utf-8") as f:
                text = f.read()
            fresh = BLOCK.sub(lambda m: m[1] + table(m[2], m[3]) + m[4], text)
            if fresh != text:
                print(path)
                with open(path, "w", encoding="utf-8") as f:
                    f.write(fresh)


main()
