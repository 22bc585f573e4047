# SPDX-License-Identifier: Apache-2.0
"""The blocks of a document and what its comments say of them."""
import dataclasses
import re

COMMANDS = ("console", "sh")
DATA = ("cmake", "cpp", "csv", "json", "python", "text", "toml")
FENCE = re.compile(r"^( *)(?:```|~~~)(\S*)$")
# Who reads the page does not see these.
NOTE = re.compile(r"^ *<!-- (?:(not run): (\S.*)|(file): (\S+)|(here): (\S+) is (\S+)) -->$")
# Around what scripts/generate-docs writes.
GENERATED = re.compile(r"^<!-- (?:[Gg]enerated\b.*|causes: .*|end(?: of causes)?) -->$")
WANTED_NOTE = "expected <!-- not run: REASON -->, <!-- file: PATH --> or <!-- here: PATH is SOURCE -->"
ITEM = re.compile(r"(?:[-*]|\d+\.) ")  # of a list, whose paragraphs and blocks are indented by four
COMMAND = re.compile(
    r"^\s*(?:\$ .*"
    r"|(?:sudo\s+)?(?:[A-Z_]+=\S*\s+)*"
    r"(?:nonio|cmake|ctest|ninja|git|python3|apt|apt-get|dpkg|cd|cp|cat|mkdir|export|systemctl|journalctl|crontab|docker|podman|openssl|loginctl"
    r"|nonio_\w+|bench_\w+|/usr/\S+|(?:\.{1,2}|\.ci|build|scripts|bench|tests|samples|debian)/\S+)(?:\s+[^=\s].*)?"
    r"|(?=[^#]*\*)(?:[\d*/,-]+\s+){5}\S.*"
    r"|@(?:reboot|hourly|daily|weekly|monthly)\s.*)$")


@dataclasses.dataclass
class Block:
    language: str
    line: int    # of the fence, from 1
    indent: str  # of the fence, in a list
    lines: list  # without that indent
    kind: str = ""  # of the note before it
    note: str = ""


@dataclasses.dataclass
class Note:
    """`here: TARGET is SOURCE`, which stands for itself."""
    line: int
    target: str
    source: str


def parts_of(text):
    """(blocks and notes in their order, what is wrong with the document: (line, message))."""
    parts, faults, pending, block, before, in_list = [], [], None, None, "", False
    for number, line in enumerate(text.splitlines(), 1):
        fence = FENCE.match(line)
        note = NOTE.match(line)
        if block is not None:
            if fence and not fence[2]:
                parts.append(block)
                faults += block_faults(block)
                block = None
            else:
                block.lines.append(line.removeprefix(block.indent))
        elif fence:
            block = Block(fence[2], number, fence[1], [], *(pending or ("", ""))[:2])
            pending = None
        elif note and note[5]:
            parts.append(Note(number, note[6], note[7]))
        elif note:
            if pending:
                faults.append(misplaced(pending))
            pending = (note[1] or note[3], note[2] or note[4], number)
        elif line.lstrip().startswith("<!--") and not GENERATED.match(line):
            faults.append((number, f"{line.strip()}: {WANTED_NOTE}"))
        elif line.strip():
            if pending:
                faults.append(misplaced(pending))
                pending = None
            if not line.startswith((" ", "\t")):
                in_list = bool(ITEM.match(line)) or in_list and bool(before.strip())
            elif not in_list and line.startswith(("    ", "\t")) and (not before.strip() or before.startswith("#") or FENCE.match(before)):
                faults.append((number, "indented block: put it between ```sh, ```console or ```text and ```"))
        before = line
    if block is not None:
        faults.append((block.line, "the block has no end"))
    if pending:
        faults.append(misplaced(pending))
    return parts, faults


def misplaced(pending):
    kind, note, line = pending
    return line, f'"{kind}: {note}" must stand just before a block'


def block_faults(block):
    faults = []
    if block.language not in COMMANDS + DATA:
        faults.append((block.line, f'block of "{block.language}": expected one of {", ".join(COMMANDS + DATA)}'))
    commands = [line for line in block.lines if COMMAND.match(line)]
    if block.language in DATA and commands and block.kind != "not run":
        faults.append((block.line, f'"{commands[0]}" looks like a command: expected ```sh or ```console,'
                       ' or the comment "not run: REASON" before the block'))
    if block.language in COMMANDS and block.kind == "file":
        faults.append((block.line, "a file that is a block of commands"))
    if not (commands if block.language in DATA else steps_of(block)) and (block.language in COMMANDS or block.kind == "not run"):
        faults.append((block.line, "there is no command in it"))
    return faults


def steps_of(block):
    """[(the command's lines as they are, their number, lines shown below it)]; of sh without the lines that are comments."""
    steps, open_ended = [], False
    for number, line in enumerate(block.lines, block.line + 1):
        begins = line.startswith("$ ") if block.language == "console" else bool(line.strip()) and not line.startswith("#")
        if open_ended:
            steps[-1][0].append(line)
        elif begins:
            steps.append(([line], number, []))
        elif steps and block.language == "console":
            steps[-1][2].append(line)
            continue
        else:
            continue
        open_ended = line.endswith("\\")
    return steps
