#!/usr/bin/env python3
"""Renders one image on OpenCue: examples/farm/opencue.py SCENE IMAGE PARTS

Frame K of the first layer renders part K; the second layer merges when all are done. The paths must be the same on all hosts.
"""
import getpass
import os
import sys

import outline
import outline.cuerun
import outline.modules.shell

scene, picture, parts = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), int(sys.argv[3])
folder = picture + ".parts"
os.makedirs(folder, exist_ok=True)

job = outline.Outline("glint", shot="picture", show="testing", user=getpass.getuser())
draw = outline.modules.shell.Shell(
    "draw", command=["glint", "render", scene, "--part", f"#IFRAME#/{parts}", "-o", f"{folder}/#IFRAME#.part"],
    chunk=1, range=f"1-{parts}")
merge = outline.modules.shell.Shell(
    "merge", command=["glint", "merge", *(f"{folder}/{part}.part" for part in range(1, parts + 1)), "-o", picture],
    range="1-1")
merge.depend_all(draw)
job.add_layer(draw)
job.add_layer(merge)
outline.cuerun.launch(job, use_pycuerun=False)
