"""The interactive documentation: Swagger UI from its network of copies, under a policy that lets in nothing else."""

import base64
import hashlib
import re
from typing import Final
from urllib.parse import urlsplit

from fastapi import APIRouter
from fastapi.openapi.docs import get_swagger_ui_html
from fastapi.responses import HTMLResponse

router = APIRouter()

# Relative, so that it is found behind a proxy that puts a folder before every path.
_HTML: Final = bytes(get_swagger_ui_html(openapi_url="openapi.json", title="Conicoid").body).decode()


def _policy(html: str) -> str:
    """A policy under which the page's own script runs, and its scripts, styles and pictures load from where it says."""
    sources = {
        kind: " ".join(sorted({f"https://{urlsplit(url).netloc}" for url in re.findall(pattern, html)}))
        for kind, pattern in (
            ("script", r'<script src="([^"]+)"'),
            ("style", r'rel="stylesheet" href="([^"]+)"'),
            ("img", r'rel="shortcut icon" href="([^"]+)"'),
        )
    }
    inline = re.findall(r"<script>(.*?)</script>", html, re.DOTALL)
    hashes = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in inline]
    own = " ".join(f"'sha256-{digest}'" for digest in hashes)
    return (
        f"default-src 'none'; script-src {sources['script']} {own}; style-src {sources['style']} 'unsafe-inline'; "
        f"img-src data: {sources['img']}; connect-src 'self'; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'none'"
    )


_HEADERS: Final = {"Content-Security-Policy": _policy(_HTML)}


@router.get("/docs", include_in_schema=False)
async def docs() -> HTMLResponse:
    """Swagger UI for `/openapi.json`."""
    return HTMLResponse(_HTML, headers=_HEADERS)
