# What there is to run.
default:
    @just --list

# The block of the paper, as in the README.
run:
    cargo run --release -- run examples/l-block.toml

# Every test of the default suite.
test:
    cargo test --workspace

# All that CI runs.
ci:
    bash .ci/run

# Long validation runs: 10,000 steps of free flight (some minutes).
validate:
    cargo test --release -p emmy --test long_flight -- --ignored --nocapture
    cargo test --release -p emmy-cli --test cli -- --ignored --nocapture

# The picture of the README.
picture:
    cargo run --release -p emmy --example tumble > docs/tumble.svg

# The documentation with all formulas.
doc:
    cargo doc --workspace --no-deps --open
