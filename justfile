# Lists the recipes.
default:
    @just --list

# The block of the paper, as in the README.
run:
    cargo run --release -- run examples/l-block.toml

# Every test of the default suite.
test:
    cargo test --workspace

# Frames as PyVista reads them (CONTRIBUTING.md says what it needs).
pyvista:
    cargo build -p emmy-cli
    python3 crates/emmy-cli/tests/pyvista/frames.py target/debug/emmy

# Mesh files of meshio, Gmsh, pyNastran and VTK, against the library that wrote them (CONTRIBUTING.md says what it needs): `just corpus --quick`.
corpus *ARGS:
    python3 crates/emmy-io/tests/corpus/corpus.py {{ARGS}}

# Everything that CI runs.
ci:
    bash .ci/run

# The paper, reproduced, and further items, with a verdict on each claim, into validation-results (some minutes).
paper:
    cargo run --release -p emmy-validation -- --quick

# Long runs: the paper with its own reference step, 10,000 and a million steps of free flight, 200 kills (many minutes).
validate:
    cargo run --release -p emmy-validation
    EMMY_MESHES="$PWD/examples/meshes" cargo test --workspace --lib --test suite --test cli --test motions -- --ignored --nocapture

# The licence texts of everything in the program, into THIRD_PARTY_NOTICES.md; run it after every change of the dependencies.
notices:
    python3 tests/licences/notices.py --write

# Licences, duplicates, sources and advisories of the dependencies (deny.toml); installs cargo-deny if it is missing.
deny:
    .ci/deny

# The built command under attack, five minutes (CONTRIBUTING.md): `just attack --quick`, `just attack kills --minutes 20`.
attack *ARGS:
    cargo build -p emmy-cli
    cargo run -p emmy-attack -- {{ARGS}}

# Times and memory compared with other programs, with a verdict on each goal (benches/README.md): `just bench --peers`, `just bench schemes`.
bench *ARGS:
    cargo run --release -p emmy-bench -- {{ARGS}}

# Times of the innermost loops.
bench-kernels:
    cargo bench -p emmy

# Program, wheel, book, licences and checksums of a release, into dist, and a trial of them (CONTRIBUTING.md).
dist:
    .ci/dist

# The book, into book/html (needs mdBook, `cargo install mdbook --locked`, and Python for formulas and drawings).
book:
    python3 book/figures.py
    mdbook build book

# Writes the present output of commands into README and book; review the diff.
listings:
    UPDATE_LISTINGS=1 cargo test -p emmy-cli --test cli listings

# The results in the book: the full set, computed on this machine (half an hour; needs CalculiX, `apt-get install calculix-ccx`).
book-results:
    cargo run --release -p emmy-validation -- --output book/src/paper --ccx ccx
    EMMY_UPDATE_DOCS=1 cargo test -p emmy-validation --test book

# Reports in a browser (needs Chromium: `apt-get install chromium`), and the picture of the README.
test-browser:
    cargo build --release -p emmy-cli
    python3 tests/browser/report.py target/release/emmy --picture book/src/figures/report.png

# The drawing of the README.
picture:
    cargo run --release -p emmy-io --example tumble > book/src/figures/tumble.svg

# The API documentation.
doc:
    cargo doc --workspace --no-deps --open
