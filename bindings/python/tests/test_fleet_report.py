"""The questions to a dataset, and the report of a fleet."""

import datetime
import re
import shutil
import sys
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("distributed", reason="Dask is not installed: `pip install flagred[fleet]`")
pytest.importorskip("duckdb", reason="DuckDB is not installed: `pip install flagred[fleet]`")

import pyarrow as pa
import pyarrow.parquet as pq

from conftest import ROOT
from flagred import fleet
from flagred.fleet.__main__ import main
from flagred.fleet.schema import MEANINGS
from test_documents import blocks

sys.path.insert(0, str(ROOT / "benches/fleet"))
import synthetic

HOSTILE = "<script>alert(1)</script>\u202e\u0007&'\""


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """4,000 flights of 40 vehicles; the risk of one rises by 1 % a week."""
    out = tmp_path_factory.mktemp("fleet") / "dataset"
    synthetic.write(out, 4000, 40, rising={"v00003": 1.0})
    return out


def flights(dataset: Path) -> list[dict]:
    files = sorted((dataset / "flights").rglob("*.parquet"))
    return [row for file in files for row in pq.ParquetFile(file).read().to_pylist()]


def test_shares_have_the_interval_of_wilson(dataset):
    assessed = [row for row in flights(dataset) if row["status"] == "assessed"]
    answer = {row["verdict"]: row for row in fleet.ask(str(dataset), "verdicts").to_pylist()}
    assert sum(row["flights"] for row in answer.values()) == len(assessed)
    n, z = len(assessed), 1.959963984540054
    for verdict in ("FAIL", "WARN", "GOOD", "NA"):
        k = sum(row["verdict"] == verdict for row in assessed)
        p = k / n
        middle, half = (p + z * z / 2 / n) / (1 + z * z / n), z / (1 + z * z / n) * np.sqrt(p * (1 - p) / n + z * z / 4 / n / n)
        assert answer[verdict]["flights"] == k
        assert answer[verdict]["low_pct"] == pytest.approx(100 * (middle - half), abs=1e-4)
        assert answer[verdict]["high_pct"] == pytest.approx(100 * (middle + half), abs=1e-4)


def judged(dataset: Path, vehicle: str) -> tuple[np.ndarray, np.ndarray]:
    rows = [row for row in flights(dataset) if row["vehicle"] == vehicle and row["status"] == "assessed" and row["verdict"] != "NA"]
    return np.array([row["start_utc"].timestamp() / 604_800 for row in rows]), np.array([row["risk_mean_pct"] for row in rows])


def test_a_trend_is_the_regression_of_scipy(dataset):
    stats = pytest.importorskip("scipy.stats", reason="scipy is not installed")
    answer = {row["vehicle"]: row for row in fleet.ask(str(dataset), "trends").to_pylist()}
    assert len(answer) == 40
    for vehicle in ("v00003", "v00010"):
        x, y = judged(dataset, vehicle)
        line = stats.linregress(x, y)
        half = line.stderr * stats.t.ppf(0.975, len(x) - 2)
        row = answer[vehicle]
        assert row["flights"] == len(x)
        assert row["slope_pct_week"] == pytest.approx(line.slope, rel=1e-6)
        assert row["low_pct_week"] == pytest.approx(line.slope - half, abs=2e-3)
        assert row["high_pct_week"] == pytest.approx(line.slope + half, abs=2e-3)
    assert answer["v00003"]["low_pct_week"] < 1 < answer["v00003"]["high_pct_week"]


def test_a_week_has_the_interval_of_student(dataset):
    stats = pytest.importorskip("scipy.stats", reason="scipy is not installed")
    row = next(row for row in fleet.ask(str(dataset), "vehicle_weeks").to_pylist() if row["flights"] >= 4)
    x, y = judged(dataset, row["vehicle"])
    begin = datetime.datetime.combine(row["week"], datetime.time(), datetime.timezone.utc).timestamp() / 604_800
    of = y[(x >= begin) & (x < begin + 1)]
    assert row["flights"] == len(of) and row["mean_pct"] == pytest.approx(of.mean())
    half = stats.t.ppf(0.975, len(of) - 1) * of.std(ddof=1) / np.sqrt(len(of))
    assert row["high_pct"] - row["mean_pct"] == pytest.approx(half, rel=0.02)


def test_what_is_rare_is_found(dataset):
    asked = {question: fleet.ask(str(dataset), question).to_pylist() for question in fleet.QUESTIONS}
    assert all(asked.values()), [question for question, rows in asked.items() if not rows]
    worst = asked["worst"][0]
    assert worst["risk_max_pct"] == max(row["risk_max_pct"] for row in flights(dataset) if row["verdict"] == "FAIL")
    assert {row["error"] for row in asked["unread"]} == {"is empty", "is a PDF document, not a flight log"}
    assert sum(row["logs"] for row in asked["unread"]) == sum(row["status"] == "unreadable" for row in flights(dataset))
    times = [row["at_risk_s"] for row in asked["time_at_risk"]]
    assert times == sorted(times, reverse=True) and len(times) == 10
    with pytest.raises(fleet.FleetError, match="there is no question `weather`"):
        fleet.ask(str(dataset), "weather")
    with pytest.raises(fleet.FleetError, match="there are no flights"):
        fleet.ask(str(dataset / "nothing"), "worst")


def test_an_alert(dataset, tmp_path, capsys):
    page = tmp_path / "fleet.html"
    assert main(["report", str(dataset), "-o", str(page), "--alert", "0.5"]) == 1
    assert capsys.readouterr().out.startswith("v00003 rises by ")
    assert "<b>v00003</b> rises by" in page.read_text()
    assert main(["report", str(dataset), "-o", str(page), "--alert", "5"]) == 0
    assert main(["report", str(dataset), "-o", str(page)]) == 0
    assert "rises" not in re.sub("<p class=soft>.*?</p>", "", page.read_text())
    assert main(["report", str(tmp_path), "-o", str(page)]) == 2


def columns(kind: str, schema: pa.Schema) -> str:
    """The columns of a table as docs/fleet.md has them."""
    lines = [f"`{kind}`:\n", "| column | unit | meaning |", "|---|---|---|"]
    for field in schema:
        unit = (field.metadata or {}).get(b"unit", b"").decode()
        lines.append(f"| `{field.name}` | {unit} | {MEANINGS[field.name]} |")
    return "\n".join(lines) + "\n"


def test_the_document_has_all_columns():
    document = (ROOT / "docs/fleet.md").read_text(encoding="utf-8")
    for kind, schema in (("flights", fleet.FLIGHTS), ("findings", fleet.FINDINGS), ("steps", fleet.STEPS)):
        assert columns(kind, schema) in document, columns(kind, schema)


def test_the_sql_of_the_document_runs(dataset, tmp_path, monkeypatch):
    import duckdb

    fleet.assess([str(ROOT / "examples/flights")], str(tmp_path / "dataset"), workers=1)
    shutil.copytree(dataset, tmp_path / "dataset", dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    ((sql, _),) = blocks("docs/fleet.md", "sql")
    connection = duckdb.connect()
    answers = [connection.execute(statement) for statement in connection.extract_statements(sql)]
    assert len(answers) == 7
    questions = [statement for statement in connection.extract_statements(sql) if "SELECT" in statement.query]
    found = [connection.execute(question).fetchall() for question in questions]
    assert all(found) and found[0][0][0] == "v00003"


def test_programs_for_other_engines_are_python():
    for text, _ in blocks("docs/fleet.md", "python"):
        compile(text, "docs/fleet.md", "exec")


class Tags(HTMLParser):
    """Balanced tags, and what they load."""

    VOID = {"meta", "line", "circle", "br", "hr"}

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.loaded: list[str] = []

    def handle_starttag(self, tag: str, attrs: list) -> None:
        self.loaded += [value for name, value in attrs if name == "src" or (name == "href" and tag != "a")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.VOID:
            assert self.open.pop() == tag


def hostile(dataset: Path, out: Path) -> None:
    """The dataset with names that would be markup."""
    shutil.copytree(dataset, out)
    for kind, names in (("flights", ("log", "vehicle", "firmware", "error", "reason")), ("findings", ("code", "rule", "side", "advice"))):
        for file in (out / kind).rglob("*.parquet"):
            table = pq.ParquetFile(file).read()
            for name in names:
                text = [value and value + HOSTILE for value in table[name].to_pylist()]
                table = table.set_column(table.column_names.index(name), table.schema.field(name), pa.array(text, pa.string()))
            pq.write_table(table, file)


def test_nothing_in_a_dataset_is_markup_and_the_page_loads_nothing(dataset, tmp_path):
    hostile(dataset, tmp_path / "hostile")
    page = tmp_path / "fleet.html"
    fleet.write_report(str(tmp_path / "hostile"), page, 0.5)
    text = page.read_text(encoding="utf-8")
    assert "alert(1)" in text and "<script>alert" not in text
    assert "\u202e" not in text and "\u0007" not in text
    tags = Tags()
    tags.feed(text)
    assert tags.open == [] and tags.loaded == []
    assert "default-src 'none'" in text


def test_the_page_in_a_browser(dataset, tmp_path):
    """On a phone and on a desktop, light and dark: nothing is asked of the network, nothing is wider than the screen."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if chromium is None:
        pytest.skip("there is no Chromium")
    page_file = tmp_path / "fleet.html"
    fleet.write_report(str(dataset), page_file, 0.5)
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for width, height in ((360, 740), (1280, 900)):
            for scheme in ("light", "dark"):
                context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
                page = context.new_page()
                asked, said = [], []
                page.on("request", lambda request: asked.append(request.url))
                page.on("console", lambda message: said.append(message.text))
                page.on("pageerror", lambda error: said.append(str(error)))
                page.goto(page_file.as_uri())
                assert asked == [page_file.as_uri()] and said == []
                assert page.evaluate("document.documentElement.scrollWidth") <= width
                assert page.locator("h2").all_text_contents()[:3] == ["Verdicts", "By week", "Vehicles"]
                assert page.locator(".charts svg").count() == 13
                box = page.locator(".charts svg").first.bounding_box()
                assert box["width"] > 250 and box["x"] + box["width"] <= width
                assert page.locator("td.log a").count() == 23
                page.screenshot(path=tmp_path / f"{width}-{scheme}.png", full_page=True)
                context.close()
        browser.close()
