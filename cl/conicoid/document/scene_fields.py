"""The keys of the document as a whole and of its output."""

from dataclasses import replace
from typing import Final, get_args

from conicoid import scene
from conicoid.document.camera_fields import CAMERA
from conicoid.document.kinds import Flag, Text, Word, Words
from conicoid.document.numeric import Numbers, NumbersOrInfinity
from conicoid.document.quadric_fields import QUADRICS
from conicoid.document.records import Field, Record
from conicoid.document.rules import VERSION
from conicoid.document.variants import ListOf

OUTPUT: Final = Record(
    noun="an output",
    fields={
        "channels": Field(
            Words(get_args(scene.Channel)),
            "what is written: Z planar depth, T distance along the ray, ZBack planar depth of the last hit of the "
            "same quadric, N unit normal, P world position, id, A coverage",
            ["Z", "N"],
        ),
        "normal_space": Field(Word(get_args(scene.NormalSpace)), "the axes of N", "world"),
        "normal_side": Field(
            Word(get_args(scene.NormalSide)),
            "where N points: facing, to the ray's side; outward, along the gradient of f",
            "facing",
        ),
        "background_depth": Field(
            NumbersOrInfinity(Numbers('a number or "inf"')), "Z, T and ZBack where nothing is hit", "inf"
        ),
        "precision": Field(Word(get_args(scene.Precision)), "the promise on every pixel's accuracy", "exact"),
        "compression": Field(Word(get_args(scene.Compression)), "the EXR file's compression, all lossless", "zip"),
        "data_window": Field(
            Word(get_args(scene.DataWindow)),
            "the pixels that are written: full, all that is rendered; tight, the hits' bounding box",
            "full",
        ),
        "half_normals": Field(Flag(), "whether N is rounded to half", False),
    },
)
_VERSION = Field(
    Numbers("1", whole=True, least=1, most=2**53, rules=(VERSION,)), "1, the version of the document format"
)
SCENE: Final = Record(
    noun="a scene document",
    fields={
        "conicoid": _VERSION,
        "quadrics": Field(QUADRICS, "the list of quadrics"),
        "scene": Field(Text(), "the id of quadrics that the service keeps, in place of quadrics"),
        "camera": Field(CAMERA, "the camera"),
        "output": Field(OUTPUT, "what is written, and how", {}),
    },
    required=("conicoid", "camera"),
    choices=(("quadrics",), ("scene",)),
    usual="quadrics",
    reserved={
        "cameras": "makes a batch, and this takes one view; give a camera, or name one of the frames "
        "(--frame K), or submit the batch as a job (POST /v1/jobs)"
    },
)
# A batch: a frame for each camera.
BATCH: Final = replace(
    SCENE,
    noun="a scene document with many cameras",
    fields={**SCENE.fields, "cameras": Field(ListOf(CAMERA, least=1), "the list of cameras, one for each frame")},
    required=("conicoid", "cameras"),
    apart=(("camera", "cameras"),),
    reserved={},
)
# What is sent to be kept: a scene document, of which only the quadrics count.
KEPT: Final = replace(
    SCENE,
    noun="a document of quadrics to keep",
    fields={key: field for key, field in SCENE.fields.items() if key != "scene"},
    required=("conicoid", "quadrics"),
    choices=(),
    usual="",
)
