"""A picture of an EXR file for people: depth beside normals, nothing where nothing was hit."""

import colorsys
import io

import cmap
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageColor

from conicoid_client.errors import ClientError
from conicoid_client.exr import ExrError, ExrImage, Mask

Rgb = NDArray[np.uint8]

# From far to near. The darkest fifth of the map is left out: it would drown on a dark page.
_DEPTH_COLOURS = (cmap.Colormap("matplotlib:magma")(np.linspace(0.2, 0.98, 1024))[:, :3] * 255).round().astype(np.uint8)

# Beyond this ratio of far to near a linear scale leaves everything near in one colour.
_LINEAR_RATIO = 8.0


class ColourError(ClientError):
    """The background is not a colour that Pillow knows."""


def png(image: ExrImage, *, width: int | None = None, background: str | None = None) -> bytes:
    """The picture as a PNG file.

    Args:
        image: what to show: depth (the first of Z, T, ZBack) beside N; without either, P, id or A.
        width: shrink the picture to this many pixels, averaging; never enlarged.
        background: colour in place of transparency, as in `white` or `#15171c`.
    Raises:
        ExrError: there is no channel that can be shown.
        ColourError: `background` is not a colour.
    """
    picture = _side_by_side([_on_display(panel, image) for panel in _panels(image)])
    if width is not None and width < picture.width:
        height = max(1, round(picture.height * width / picture.width))
        picture = picture.resize((width, height), Image.Resampling.LANCZOS)
    if background is not None:
        flat = Image.new("RGBA", picture.size, _colour(background))
        flat.alpha_composite(picture)
        picture = flat.convert("RGB")
    file = io.BytesIO()
    picture.save(file, "PNG")
    return file.getvalue()


def _colour(name: str) -> str:
    try:
        ImageColor.getrgb(name)
    except ValueError:
        raise ColourError(f"{name!r} is not a colour; give a name such as white or a code such as #15171c") from None
    return name


def _panels(image: ExrImage) -> list[Image.Image]:
    hits = image.hits()
    if hits is None:
        raise ExrError(
            f"it has no depth, normals, positions, ids or coverage to show, only {', '.join(image.channels)}"
        )
    depth, normals = image.depth(), image.vector("N")
    colours = []
    if depth is not None:
        colours.append(depth_colours(depth, hits))
    if normals is not None:
        colours.append(normal_colours(normals))
    if not colours:
        colours.append(_other_colours(image, hits))
    seen = hits[..., None]
    return [Image.fromarray(np.concatenate([rgb * seen, 255 * seen.astype(np.uint8)], axis=-1)) for rgb in colours]


def depth_colours(depth: NDArray[np.floating], hits: Mask) -> Rgb:
    """Depth by a perceptually uniform map, near bright; (h, w) to (h, w, 3).

    The scale spans all but the nearest and farthest half per cent of the hits, linearly, or logarithmically where
    it spans more than a factor of eight.
    """
    z = depth.astype(np.float64)
    seen = z[hits & np.isfinite(z)]
    if not seen.size:
        return _DEPTH_COLOURS[np.zeros(depth.shape, np.intp)]
    near, far = np.quantile(seen, [0.005, 0.995])
    if near > 0 and near * _LINEAR_RATIO < far:
        near, far = np.log(near), np.log(far)
        z = np.log(np.maximum(z, np.finfo(np.float64).tiny))
    span = far - near if far > near else 1.0
    nearness = np.nan_to_num(np.clip((far - z) / span, 0.0, 1.0)) if far > near else np.ones_like(z)
    return _DEPTH_COLOURS[(nearness * (len(_DEPTH_COLOURS) - 1)).astype(np.intp)]


def normal_colours(normals: NDArray[np.floating]) -> Rgb:
    """Unit normals as (n + 1) / 2 in red, green, blue; (h, w, 3)."""
    n = np.nan_to_num(normals.astype(np.float32))
    return np.asarray(np.clip((n + 1) * 127.5, 0, 255).round().astype(np.uint8))


def _other_colours(image: ExrImage, hits: Mask) -> Rgb:
    if (position := image.vector("P")) is not None:
        return _position_colours(position, hits)
    if "id" in image.channels:
        # Steps of the golden angle keep the hues of neighbouring ids apart.
        hues = [colorsys.hsv_to_rgb(k * 0.6180339887 % 1, 0.55, 0.95) for k in range(4096)]
        return np.asarray((np.array(hues) * 255).astype(np.uint8)[image.channels["id"] % 4096])
    return np.broadcast_to(_DEPTH_COLOURS[-1], (*hits.shape, 3))


def _position_colours(position: NDArray[np.floating], hits: Mask) -> Rgb:
    """Position within the hits' bounding box as red, green, blue."""
    p = np.nan_to_num(position.astype(np.float64))
    if not hits.any():
        return np.zeros(position.shape, np.uint8)
    low, high = np.quantile(p[hits], [0.005, 0.995], axis=0)
    scale = np.where(high > low, high - low, 1.0)
    return np.asarray((np.clip((p - low) / scale, 0, 1) * 255).astype(np.uint8))


def _on_display(panel: Image.Image, image: ExrImage) -> Image.Image:
    """The data window's panel in its place on the display window, clear around it."""
    x0, y0, x1, y1 = image.display_window
    whole = Image.new("RGBA", (x1 - x0, y1 - y0))
    whole.paste(panel, (image.data_window[0] - x0, image.data_window[1] - y0))
    return whole


def _side_by_side(panels: list[Image.Image]) -> Image.Image:
    picture = Image.new("RGBA", (sum(panel.width for panel in panels), panels[0].height))
    x = 0
    for panel in panels:
        picture.paste(panel, (x, 0))
        x += panel.width
    return picture
