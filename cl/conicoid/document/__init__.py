"""The scene document: JSON in, columns checked, arrays resolved.

`json_text` reads strictly; `quadric_fields`, `camera_fields` and `scene_fields` are the one table of what a document
may say, made of `kinds`, `numeric`, `records` and `variants`, which also give the JSON Schema; `resolve` and `camera`
derive a scene's numbers; `npz` reads the arrays that come beside it, `references` and `sets` put them in place.
"""

from conicoid.document.document import Batch, Document, parse, parse_batch, parse_quadrics
from conicoid.document.npz import read_npz

__all__ = ["Batch", "Document", "parse", "parse_batch", "parse_quadrics", "read_npz"]
