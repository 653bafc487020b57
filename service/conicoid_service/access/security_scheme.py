"""What the OpenAPI document says about API keys, where they are set."""

from typing import Any, Final

from conicoid_service.access.gate import OPEN

_SCHEME: Final = {"type": "http", "scheme": "bearer", "description": "an API key of this service"}


def require_keys(document: dict[str, Any], refusals: dict[int | str, dict[str, Any]]) -> None:
    """Declare the bearer scheme for every operation but the open ones, and how it refuses.

    Args:
        document: an OpenAPI document; changed in place.
        refusals: the responses of a request without a key, or with too many others of its own.
    """
    document["components"]["securitySchemes"] = {"key": _SCHEME}
    document["security"] = [{"key": []}]
    for path, operations in document["paths"].items():
        for operation in operations.values():
            if path in OPEN:
                operation["security"] = []
            else:
                for status, refusal in refusals.items():
                    operation["responses"].setdefault(str(status), refusal)
