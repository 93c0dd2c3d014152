"""The questions to a dataset, and the report of a fleet."""

import datetime
import html
import json
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
import flagred
from flagred import fleet
from flagred.fleet.__main__ import main
from flagred.fleet.names import read_names, read_parts
from flagred.fleet.schema import MEANINGS
from test_documents import blocks

sys.path.insert(0, str(ROOT / "benches/fleet"))
import synthetic

HOSTILE = "<script>alert(1)</script>\u202e\u0007&'\""


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """4,000 flights of 40 vehicles; the risk of one rises by 1 % per week."""
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


def test_a_vehicle_has_its_counts_and_its_weakest_motor(dataset):
    rows = [row for row in flights(dataset) if row["vehicle"] == "v00003" and row["status"] == "assessed" and row["verdict"] != "NA"]
    answer = next(row for row in fleet.ask(str(dataset), "vehicles").to_pylist() if row["vehicle"] == "v00003")
    assert answer["flights"] == len(rows)
    assert answer["warned"] == sum(row["verdict"] in ("WARN", "FAIL") for row in rows)
    assert answer["failed"] == sum(row["verdict"] == "FAIL" for row in rows)
    assert answer["risk_mean_pct"] == pytest.approx(np.mean([row["risk_mean_pct"] for row in rows]))
    assert answer["weakest_motor"] is None and answer["site"] is None


def test_causes_are_words_for_a_pilot(dataset):
    causes = fleet.ask(str(dataset), "causes").to_pylist()
    assert {cause["code"] for cause in causes} == {code for code, _, _ in synthetic.CAUSES}
    for cause in causes:
        text, advice = next((text, advice) for code, text, advice in synthetic.CAUSES if code == cause["code"])
        # The texts do not contain the numbers of a single flight.
        assert cause["what"] == text and cause["advice"] == advice
        assert cause["flights"] == cause["findings"] and 1 <= cause["vehicles"] <= 40


def test_rare_findings_are_listed(dataset):
    asked = {question: fleet.ask(str(dataset), question).to_pylist() for question in fleet.QUESTIONS}
    assert all(asked.values()), [question for question, rows in asked.items() if not rows]
    worst = asked["worst"][0]
    assert worst["risk_max_pct"] == max(row["risk_max_pct"] for row in flights(dataset) if row["verdict"] == "FAIL")
    assert {row["error"] for row in asked["unread"]} == {"is empty", "is a PDF document, not a flight log"}
    assert sum(row["logs"] for row in asked["unread"]) == sum(row["status"] == "unreadable" for row in flights(dataset))
    times = [row["at_risk_s"] for row in asked["time_at_risk"]]
    assert times == sorted(times, reverse=True) and len(times) == 10
    with pytest.raises(fleet.FleetError, match="`weather` is not a question"):
        fleet.ask(str(dataset), "weather")
    with pytest.raises(fleet.FleetError, match="there are no flights"):
        fleet.ask(str(dataset / "nothing"), "worst")


def test_an_alert(dataset, tmp_path, capsys):
    page, document, received = tmp_path / "fleet.html", tmp_path / "alerts.json", tmp_path / "received.json"
    arguments = ["report", str(dataset), "-o", str(page)]
    with_command = ["--alert-json", str(document), "--alert-command", f"cat >> {received}"]
    assert main([*arguments, "--alert", "5", *with_command]) == 1
    assert capsys.readouterr().out.startswith("v00003 grows riskier: ")
    found = json.loads(document.read_text())
    assert json.loads(received.read_text()) == found and found["last_report_utc"] is None
    (alert,) = found["alerts"]
    assert (alert["vehicles"], alert["kind"], alert["is_fleet"], alert["is_new"]) == (["v00003"], "slope", False, True)
    assert alert["interval_pct"][0] < alert["change_pct"] < alert["interval_pct"][1] and alert["p"] <= found["level"]
    assert alert["interval_pct"][0] / alert["change_pct"] * alert["slope_pct_week"] < 1 < alert["interval_pct"][1] / alert["change_pct"] * alert["slope_pct_week"]
    assert alert["text"] in html.unescape(page.read_text()) and alert["advice"].startswith("Check propellers")
    # The command receives each alert once; the exit code stays the same.
    received.unlink()
    assert main([*arguments, "--alert", "5", *with_command]) == 1
    assert not received.exists()
    assert json.loads(document.read_text())["alerts"][0]["is_new"] is False
    assert main([*arguments, "--alert", "90"]) == 0
    assert main(arguments) == 0
    capsys.readouterr()
    assert main([*arguments, "--alert-json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["flights"] == sum(row["flights"] for row in fleet.ask(str(dataset), "verdicts").to_pylist())
    assert main(["report", str(tmp_path), "-o", str(page)]) == 2


def test_a_command_that_fails_is_run_again(dataset, tmp_path, capsys):
    arguments = ["report", str(dataset), "-o", str(tmp_path / "fleet.html"), "--alert-command", "exit 7"]
    for _ in range(2):
        assert main(arguments) == 2
        assert "error: the alert command failed with exit code 7: `exit 7`" in capsys.readouterr().err
    assert (tmp_path / "fleet.html").exists()


def test_news_since_the_last_report(dataset, tmp_path):
    out, page = tmp_path / "dataset", tmp_path / "fleet.html"
    shutil.copytree(dataset, out)
    fleet.write_report(str(out), page)
    assert "New since the report" not in page.read_text()
    later = pq.ParquetFile(next((out / "flights").glob("month=2026-03/*"))).read().slice(0, 5)
    for name, values in {
        "flight_id": [f"new{i}" for i in range(5)],
        "log": [f"/logs/new{i}.BIN" for i in range(5)],
        "vehicle": ["v00001", "v00001", "fresh", "fresh", None],
        "status": ["assessed"] * 5,
        "verdict": ["FAIL", "GOOD", "GOOD", "GOOD", "GOOD"],
        "findings": [0] * 5,
        "assessed_s": [100.0] * 5,
        "risk_max_pct": [99.5, 20.0, 20.0, 20.0, 20.0],
    }.items():
        later = later.set_column(later.column_names.index(name), later.schema.field(name), pa.array(values, later.schema.field(name).type))
    pq.write_table(later, out / "flights/month=2026-03/later.parquet")
    report = fleet.write_report(str(out), page)
    assert (report.document["new_flights"], report.document["new_warned"]) == (5, 1)
    part = page.read_text().partition("New since the report of ")[2].partition("<h2>Worst flights")[0]
    assert "5 new flights, 1 of them warned." in part and ">fresh</a>." in part and "/logs/new0.BIN" in part
    assert fleet.write_report(str(out), page).document["new_flights"] == 0
    # Without the data of the last report, nothing is called new.
    (tmp_path / "fleet.files/last.json").write_text("{")
    assert fleet.write_report(str(out), page).document["last_report_utc"] is None


def test_names_sites_and_pilots(dataset, tmp_path, capsys):
    names, page = tmp_path / "names.csv", tmp_path / "fleet.html"
    names.write_text("\ufeffSerial;Name;Site;Pilot;Colour\nv00003;Heron;North;Ann;red\nv00004;Stork;South;;blue\nv9;Crane;North;Ben;green\n", encoding="utf-8")
    connection = fleet.open_dataset(str(dataset), names, {"site": "North"})
    (row,) = fleet.ask(connection, "vehicles").to_pylist()
    assert (row["vehicle"], row["site"], row["pilot"]) == ("Heron", "North", "Ann")
    assert {row["vehicle"] for row in fleet.ask(connection, "worst").to_pylist()} == {"Heron"}
    assert connection.execute("SELECT DISTINCT vehicle FROM findings").fetchall() == [("Heron",)]
    arguments = ["report", str(dataset), "-o", str(page), "--names", str(names)]
    assert main([*arguments, "--only", "site=North", "--only", "pilot=Ann", "--alert"]) == 1
    assert capsys.readouterr().out.startswith("Heron grows riskier")
    assert "Stork" not in page.read_text()
    assert main(arguments) == 0 and "Stork" in page.read_text()
    capsys.readouterr()
    for wrong, message in (
        (["--only", "site=East"], "no flight has site `East`"),
        (["--only", "colour=red"], "there is no filter `colour`"),
        (["--only", "site=North", "--only", "site=South"], "a filter is repeated"),
    ):
        assert main([*arguments, *wrong]) == 2 and message in capsys.readouterr().err
    assert main(["report", str(dataset), "-o", str(page), "--only", "site=North"]) == 2
    assert "name a CSV file with `--names`" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name,site\nHeron,North\n", "has no column `vehicle`"),
        ("vehicle,name\na,X\na,Y\n", "line 3: vehicle `a` is listed twice"),
        ("vehicle,name\na,X\nb,X\n", "line 3: vehicles `a` and `b` have the same name `X`"),
        ("vehicle,name\na,X\n", "no vehicle of"),
        ("", "has no column `vehicle`"),
    ],
)
def test_mistakes_in_names_are_reported_with_their_line(text, message, dataset, tmp_path):
    (tmp_path / "names.csv").write_text(text)
    with pytest.raises(fleet.FleetError, match=re.escape(message)):
        fleet.open_dataset(str(dataset), tmp_path / "names.csv")


def test_parts_of_named_vehicles(tmp_path):
    names, parts = tmp_path / "names.csv", tmp_path / "parts.csv"
    names.write_text("vehicle,name\nv1,Heron\n")
    parts.write_text("vehicle,day,part\nv1,2026-03-01,new propellers\nHeron,2026-04-01,new motor 2\n")
    read = read_parts(parts, read_names(names))
    assert [(datetime.datetime.fromtimestamp(at_s, datetime.timezone.utc).month, part) for at_s, part in read["Heron"]] == [
        (3, "new propellers"),
        (4, "new motor 2"),
    ]
    parts.write_text("vehicle,day,part\nv1,1 March,propellers\n")
    with pytest.raises(fleet.FleetError, match="line 2: `1 March` is not a day"):
        read_parts(parts, read_names(names))
    parts.write_text("vehicle,day\nv1,2026-03-01\n")
    with pytest.raises(fleet.FleetError, match="has no column `part`"):
        read_parts(parts, read_names(names))


def test_reports_of_the_worst_flights(tmp_path, capsys):
    """An existing log has its report, linked from the fleet's page and the vehicle's; a deleted one is named."""
    logs, out, page = tmp_path / "logs/vehicle=one", tmp_path / "out", tmp_path / "fleet.html"
    logs.mkdir(parents=True)
    for name in ("a", "b"):
        rows = "".join(f"{i / 25},1,0.4,0.41,0.41,1\n" for i in range(500))
        (logs / f"{name}.csv").write_text(f"# utc_at_zero_s: 1790000000\n# {name}: x\nt_s,motor1,motor2,motor3,motor4,in_air\n" + rows)
    fleet.assess([str(tmp_path / "logs")], str(out), recursive=True, workers=1)
    (logs / "b.csv").unlink()
    arguments = ["report", str(out), "-o", str(page), "--reports", "worst:20"]
    assert main(arguments) == 0
    assert f"warning: no report of {logs / 'b.csv'}: " in capsys.readouterr().err
    (written,) = (tmp_path / "fleet.files/flights").glob("*.html")
    assert "a.csv" in written.read_text() and flagred.assess(logs / "a.csv").verdict in written.read_text()
    assert f"href='fleet.files/flights/{written.name}'" in page.read_text()
    (vehicle,) = (tmp_path / "fleet.files/vehicles").glob("one-*.html")
    # Two flights on one day do not prove that nothing changed.
    assert "0 of 1 vehicles have flights on at least 8 days" in page.read_text()
    assert "Whether the risk of this vehicle changes is unknown: it has flights on fewer than 8 days." in vehicle.read_text()
    assert f"href='../flights/{written.name}'" in vehicle.read_text() and "href='../../fleet.html'" in vehicle.read_text()
    # An existing report is not written again, so its log may be missing.
    (logs / "a.csv").unlink()
    assert main(arguments) == 0 and f"href='fleet.files/flights/{written.name}'" in page.read_text()
    with pytest.raises(SystemExit):
        main(["report", str(out), "-o", str(page), "--reports", "worst:none"])


def columns(kind: str, schema: pa.Schema) -> str:
    """The columns of a table in docs/fleet.md."""
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
    """Checks that tags are balanced, and collects the files that they load."""

    VOID = {"meta", "path", "input", "br", "hr"}

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
    for kind, names in (("flights", ("log", "vehicle", "vehicle_id", "firmware", "error", "reason")), ("findings", ("code", "rule", "side", "text", "advice"))):
        for file in (out / kind).rglob("*.parquet"):
            table = pq.ParquetFile(file).read()
            for name in names:
                text = [value and value + HOSTILE for value in table[name].to_pylist()]
                table = table.set_column(table.column_names.index(name), table.schema.field(name), pa.array(text, pa.string()))
            pq.write_table(table, file)


def test_nothing_in_a_dataset_is_markup_and_the_page_loads_nothing(dataset, tmp_path):
    hostile(dataset, tmp_path / "hostile")
    page = tmp_path / "fleet.html"
    fleet.write_report(str(tmp_path / "hostile"), page)
    pages = [page, *(tmp_path / "fleet.files/vehicles").glob("*.html")]
    assert len(pages) == 41
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert "alert(1)" in text and "<script>alert" not in text
        assert "\u202e" not in text and "\u0007" not in text
        tags = Tags()
        tags.feed(text)
        assert tags.open == [] and tags.loaded == []
        assert "default-src 'none'" in text


def test_the_page_in_a_browser(dataset, tmp_path):
    """On a phone and on a desktop, light and dark: the page makes no network request, and nothing is wider than the screen."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if chromium is None:
        pytest.skip("there is no Chromium")
    page_file = tmp_path / "fleet.html"
    fleet.write_report(str(dataset), page_file)
    (vehicle_file,) = (tmp_path / "fleet.files/vehicles").glob("v00003-*.html")
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

                def fits() -> None:
                    """Checks that nothing is cut off at the right, including tables."""
                    assert page.evaluate("document.documentElement.scrollWidth") <= width
                    page.evaluate("document.querySelectorAll('details').forEach((part) => (part.open = true))")
                    wider = "[...document.querySelectorAll('.scroll')].filter((box) => box.scrollWidth > box.clientWidth + 1).length"
                    assert page.evaluate(wider) == 0
                    box = page.locator("figure .area").first.bounding_box()
                    assert box["width"] > 250 and box["x"] + box["width"] <= width

                page.goto(page_file.as_uri())
                assert asked == [page_file.as_uri()]
                assert page.locator("h2").all_text_contents()[:3] == ["What to act on", "Worst flights", "Causes"]
                assert page.locator("ul.act li").count() == 1 and page.locator("ul.act li b").text_content() == "v00003"
                fits()
                page.locator("#find").fill("v00017")
                assert page.locator("#vehicles tbody tr:visible").count() == 1
                page.screenshot(path=tmp_path / f"{width}-{scheme}.png", full_page=True)
                page.locator("ul.act a").first.click()
                assert page.url == vehicle_file.as_uri() and "grows riskier" in page.locator("ul.act").text_content()
                assert page.locator("figure .dot:not(.under)").count() > 50
                fits()
                page.screenshot(path=tmp_path / f"vehicle-{width}-{scheme}.png", full_page=True)
                assert said == []
                context.close()
        browser.close()
