"""Metrics as a monitoring system reads them."""

from collections import Counter

import httpx
from prometheus_client.parser import text_string_to_metric_families

Samples = Counter[tuple[str, frozenset[tuple[str, str]]]]


async def scraped(client: httpx.AsyncClient) -> Samples:
    """Each sample's value by its name and labels; a sample that is not there counts 0."""
    response = await client.get("/metrics")
    assert response.headers["content-type"].startswith("text/plain; version=0.0.4")
    families = text_string_to_metric_families(response.text)
    return Counter(
        {(one.name, frozenset(one.labels.items())): one.value for family in families for one in family.samples}
    )


def sample(name: str, **labels: str) -> tuple[str, frozenset[tuple[str, str]]]:
    return f"conicoid_{name}", frozenset(labels.items())
