#!/usr/bin/python3
"""checkPage.py PAGE REPORT: holds a comparison's page (index.html) against its report.json.

The page must be well-formed XML, load nothing from outside, and every text with a digit in it must say by a JSON
pointer ("data-json") where it stands in the report: figures round the value there to the digits shown, names are
equal to it. Prints one line a finding; exit status 1 where there are any.
"""
import decimal
import json
import re
import sys
import xml.etree.ElementTree as ElementTree

XHTML = "{http://www.w3.org/1999/xhtml}"
UNITS = {"": "1", "ms": "1e-3", "kB": "1024", "MB": "1048576", "M/s": "1e6", "dB": "1"}
LEAST_DIGITS = 3
LOADING = ("src", "srcset", "data", "poster", "background", "action", "{http://www.w3.org/1999/xlink}href")
FORBIDDEN = ("script", "link", "iframe", "object", "embed", "base")
NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def lookup(report, pointer):
    value = report
    for part in pointer.split("/")[1:]:
        part = part.replace("~1", "/").replace("~0", "~")
        value = value[int(part)] if isinstance(value, list) else value[part]
    return value


def figure_error(element, value):
    """What is wrong with a number of the page, or None."""
    text = element.text or ""
    if isinstance(value, bool) or not isinstance(value, decimal.Decimal):
        return "is no number in the report"
    if decimal.Decimal(element.get("value", "nan")) != value:
        return "has a value that is not the report's"
    if element.get("data-unit", "") not in UNITS or not re.fullmatch(r"-?\d+(\.\d+)?(e[+-]\d+)?", text):
        return "is no figure in a known unit"
    scaled = value / decimal.Decimal(UNITS[element.get("data-unit", "")])
    shown = decimal.Decimal(text)
    # Half a unit in the last place shown, and what dividing in double precision may add.
    if abs(shown - scaled) > decimal.Decimal(1).scaleb(shown.as_tuple().exponent) / 2 + abs(scaled) * decimal.Decimal("1e-15"):
        return f"does not round the report's {scaled}"
    if shown != scaled and len(shown.as_tuple().digits) < LEAST_DIGITS:
        return f"shows too few digits of the report's {scaled}"
    return None


def name_error(element, value):
    if not isinstance(value, str):
        return "is no text in the report"
    return None if "".join(element.itertext()) == NOT_XML.sub("\ufffd", value) else "is not the report's text"


def text_errors(element, report, found):
    """Checks the text below an element; texts after it belong to its parent."""
    tag = element.tag.removeprefix(XHTML)
    pointer = element.get("data-json")
    if pointer is not None:
        found.append(pointer)
        try:
            value = lookup(report, pointer)
        except (KeyError, IndexError, ValueError, TypeError):
            yield f"{pointer}: is not in the report"
            return
        error = figure_error(element, value) if tag == "data" else name_error(element, value)
        if error:
            yield f"{pointer}: \"{''.join(element.itertext())}\" {error}"
        return
    texts = [element.text] + [child.tail for child in element]
    for text in texts:
        if text and re.search(r"\d", text):
            yield f"<{tag}>: \"{text.strip()}\" has a figure that does not say where it stands in the report"
    for child in element:
        yield from text_errors(child, report, found)


def link_errors(root):
    ids = [element.get("id") for element in root.iter() if element.get("id") is not None]
    if len(ids) != len(set(ids)):
        yield "an id is used twice"
    for element in root.iter():
        tag = element.tag.removeprefix(XHTML)
        if tag in FORBIDDEN:
            yield f"<{tag}>: is not allowed"
        for name in LOADING:
            if element.get(name) is not None and not element.get(name).startswith("data:"):
                yield f"<{tag}>: {name}=\"{element.get(name)[:80]}\" is not inlined"
        href = element.get("href")
        if href is not None and not (href in ("report.json", "report.csv") or href.startswith("#") and href[1:] in ids):
            yield f"<{tag}>: href=\"{href[:80]}\" leads out of the page"
        if tag == "style" and re.search("[<>&\"]", element.text or ""):
            yield "<style>: HTML would read it in another way than XML"
        style = (element.get("style") or "") + (element.text or "" if tag == "style" else "")
        if "url(" in style or "@import" in style:
            yield f"<{tag}>: its style loads something"


def page_errors(page, report):
    if not page.startswith("<!DOCTYPE html>"):
        yield "expected <!DOCTYPE html> at the beginning"
    try:
        root = ElementTree.fromstring(page)
    except ElementTree.ParseError as error:
        yield f"not well-formed: {error}"
        return
    found = []
    body = root.find(XHTML + "body")
    if root.tag != XHTML + "html" or body is None:
        yield "expected <html> of XHTML with a <body>"
        return
    yield from text_errors(body, report, found)
    yield from link_errors(root)
    # Each measured case has its figures or its error on the page.
    for i, case in enumerate(report["cases"]):
        failed_choice = any(c["key"] == case["choice"] and c["status"] == "failed" for c in report["choices"])
        expected = "/error" if case["status"] == "failed" else "/seconds_frame/median"
        if f"/cases/{i}{expected}" not in found and not (case["status"] == "failed" and failed_choice):
            yield f"/cases/{i}{expected}: is missing on the page"


def main():
    with open(sys.argv[1], encoding="utf-8", newline="") as file:
        page = file.read()
    with open(sys.argv[2], encoding="utf-8") as file:
        report = json.load(file, parse_int=decimal.Decimal, parse_float=decimal.Decimal)
    errors = list(page_errors(page, report))
    for error in errors:
        print(f"{sys.argv[1]}: {error}")
    sys.exit(1 if errors else 0)


if __name__ == "__main__":
    main()
