"""The dashboard and the documentation speak of metrics that exist, and the documentation of all of them."""

import json
import re
from collections.abc import Iterator
from typing import Any

from prometheus_client.core import Metric

from conicoid_service.farm.watch import Watch
from conicoid_service.telemetry.metrics import Metrics
from conicoid_service.telemetry.watched import WATCHED
from tests.checkout import ROOT

DASHBOARD: dict[str, Any] = json.loads((ROOT / "docker/grafana/conicoid.json").read_text("utf-8"))
# The API's metrics and the workers'.
PAGES = "\n".join((ROOT / "docs" / name).read_text("utf-8") for name in ("operations.md", "farm.md"))


def families() -> list[Metric]:
    return [*Metrics().registry.collect(), *Watch(0).registry.collect()]


def exported() -> dict[str, bool]:
    """Each metric as a query names it, and whether it is ours rather than every process'; histograms without suffix."""
    suffix = {"counter": "_total", "info": "_info"}
    own = {f"{family.name}{suffix.get(family.type, '')}": family.name.startswith("conicoid") for family in families()}
    watched = {f"{name}{suffix.get(about.kind, '')}": True for name, about in WATCHED.items()}
    return own | watched


def queries() -> Iterator[str]:
    for panel in DASHBOARD["panels"]:
        for target in panel["targets"]:
            yield target["expr"]
    for variable in DASHBOARD["templating"]["list"]:
        if variable["type"] == "query":
            yield variable["definition"]


def named(text: str) -> set[str]:
    """The metrics that a text names; a histogram's parts as the histogram."""
    found = set(re.findall(r"\b(?:conicoid|process)_[a-z_]+", text))
    return {re.sub(r"(_seconds)_(?:bucket|sum|count)$", r"\1", name) for name in found}


def test_every_query_of_the_dashboard_names_metrics_that_exist() -> None:
    for query in queries():
        assert named(query), query
        assert named(query) <= exported().keys(), query


def test_every_metric_of_ours_but_the_table_s_rarest_is_on_the_dashboard() -> None:
    shown = set().union(*map(named, queries()))
    assert {name for name, ours in exported().items() if ours} - shown == {"conicoid_quadrics_total"}


def test_the_dashboard_takes_whichever_data_source_is_chosen() -> None:
    assert DASHBOARD["templating"]["list"][0]["type"] == "datasource"
    sources = [source for panel in DASHBOARD["panels"] for source in (panel, *panel["targets"])]
    assert {source["datasource"]["uid"] for source in sources} == {"${datasource}"}


def test_the_documentation_has_every_metric_of_ours_and_no_other() -> None:
    rows = re.findall(r"^\| (`conicoid_.*?) \| (?:counter|gauge|histogram) \|", PAGES, re.MULTILINE)
    assert set().union(*map(named, rows)) == {name for name, ours in exported().items() if ours}
    assert {name for name in named(PAGES) if name != "process_"} <= exported().keys()
