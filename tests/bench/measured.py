#!/usr/bin/env python3
"""Measured tables in the READMEs, made anew: `./run study`, or of some folders of plugins `./run study fog_volume sky`.

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
    brume, only = os.path.abspath(sys.argv[1]), sys.argv[2:]
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

        paths = [f"plugins/{name}/README.md" for name in only]
        if not only:
            table(*CHART[:2])
            paths = sorted(glob.glob("plugins/*/README.md"))
        for path in paths:
            with open(path, encoding="utf-8") as f:
                text = f.read()
            fresh = BLOCK.sub(lambda m: m[1] + table(m[2], m[3]) + m[4], text)
            if fresh != text:
                print(path)
                with open(path, "w", encoding="utf-8") as f:
                    f.write(fresh)


main()
