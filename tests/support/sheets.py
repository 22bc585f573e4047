# SPDX-License-Identifier: Apache-2.0
"""Spreadsheets made by hand, for tests: the smallest XLSX and ODS files that spreadsheet programs open."""
import zipfile
from xml.sax.saxutils import escape, quoteattr

HEAD = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
REL = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"


class Date(float):
    """A number that a cell shows as a date."""


class Formula(str):
    """A formula, whose value is that of the cell after "="."""


def column(k):
    return (column(k // 26 - 1) if k >= 26 else "") + chr(65 + k % 26)


def cell(r, k, value, strings):
    at = f'r="{column(k)}{r}"'
    if value is None or value == "":
        return ""
    if isinstance(value, Date):
        return f'<c {at} s="1"><v>{float(value)!r}</v></c>'
    if isinstance(value, Formula):
        formula, result = value.split("=", 1)
        return f"<c {at}><f>{escape(formula)}</f><v>{escape(result)}</v></c>"
    if isinstance(value, (int, float)):
        return f"<c {at}><v>{value!r}</v></c>"
    if value.startswith("#"):
        return f'<c {at} t="e"><v>{escape(value)}</v></c>'
    strings.setdefault(value, len(strings))
    return f'<c {at} t="s"><v>{strings[value]}</v></c>'


def xlsx(path, sheets, more=(), doctype=""):
    """sheets: name -> rows of values. `more`: further members, name -> bytes."""
    strings = {}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as z:
        z.writestr("[Content_Types].xml", HEAD + f'<Types xmlns="{PACKAGE}/content-types">'
                   '<Default Extension="xml" ContentType="application/xml"/>'
                   '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/></Types>')
        for n, rows in enumerate(sheets.values(), 1):
            body = "".join(f'<row r="{r}">' + "".join(cell(r, k, v, strings) for k, v in enumerate(row)) + "</row>"
                           for r, row in enumerate(rows, 1))
            z.writestr(f"xl/worksheets/sheet{n}.xml", HEAD + doctype + f'<worksheet xmlns="{MAIN}"><sheetData>{body}</sheetData></worksheet>')
        names = "".join(f'<sheet name={quoteattr(name)} sheetId="{n}" r:id="rId{n}"/>' for n, name in enumerate(sheets, 1))
        z.writestr("xl/workbook.xml", HEAD + f'<workbook xmlns="{MAIN}" xmlns:r="{REL}"><sheets>{names}</sheets></workbook>')
        targets = "".join(f'<Relationship Id="rId{n}" Type="{REL}/worksheet" Target="worksheets/sheet{n}.xml"/>'
                          for n in range(1, len(sheets) + 1))
        z.writestr("xl/_rels/workbook.xml.rels", HEAD + f'<Relationships xmlns="{PACKAGE}/relationships">{targets}</Relationships>')
        texts = "".join(f"<si><t>{escape(s)}</t></si>" for s in strings)
        z.writestr("xl/sharedStrings.xml", HEAD + f'<sst xmlns="{MAIN}">{texts}</sst>')
        z.writestr("xl/styles.xml", HEAD + f'<styleSheet xmlns="{MAIN}"><cellXfs><xf numFmtId="0"/><xf numFmtId="22"/></cellXfs></styleSheet>')
        for name, data in dict(more).items():
            z.writestr(name, data)


def ods(path, sheets):
    tables = ""
    for name, rows in sheets.items():
        body = ""
        for row in rows:
            cells = ""
            for value in row:
                if value is None or value == "":
                    cells += "<table:table-cell/>"
                elif isinstance(value, (int, float)):
                    cells += f'<table:table-cell office:value-type="float" office:value="{value!r}"><text:p>{value:.1f}</text:p></table:table-cell>'
                else:
                    cells += f'<table:table-cell office:value-type="string"><text:p>{escape(value)}</text:p></table:table-cell>'
            body += f"<table:table-row>{cells}</table:table-row>"
        tables += f"<table:table table:name={quoteattr(name)}>{body}</table:table>"
    space = "urn:oasis:names:tc:opendocument:xmlns:"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as z:
        z.writestr(zipfile.ZipInfo("mimetype"), "application/vnd.oasis.opendocument.spreadsheet")
        z.writestr("content.xml", HEAD + f'<office:document-content xmlns:office="{space}office:1.0" xmlns:table="{space}table:1.0" '
                   f'xmlns:text="{space}text:1.0"><office:body><office:spreadsheet>{tables}</office:spreadsheet></office:body></office:document-content>')
