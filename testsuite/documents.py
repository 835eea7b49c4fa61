"""What the documents promise: documents.py links <root> checks relative links, documents.py commands <file> [--without WORD]...
prints the shell blocks (```sh), leaving out commands with one of the words."""
import pathlib
import re
import sys


def anchors(path):
    headings = re.findall(r"^#+ +(.+)$", without_blocks(path.read_text()), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings}


def without_blocks(text):
    return re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)


def broken_links(root):
    documents = [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("models/*.md")]
    for document in documents:
        for target in re.findall(r"\]\(([^)\s]+)\)", without_blocks(document.read_text())):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            place = (document.parent / path) if path else document
            if not place.exists():
                yield f"{document}: {target} does not exist"
            elif anchor and anchor not in anchors(place):
                yield f"{document}: {target} is no heading"


def commands(document, left_out):
    for block in re.findall(r"^```sh\n(.*?)^```", document.read_text(), flags=re.S | re.M):
        for command in block.replace("\\\n", " ").splitlines():
            if not any(word in command for word in left_out):
                yield command


if sys.argv[1] == "links":
    problems = list(broken_links(pathlib.Path(sys.argv[2])))
    print("\n".join(problems))
    sys.exit(1 if problems else 0)
print("\n".join(commands(pathlib.Path(sys.argv[2]), sys.argv[4::2])))
