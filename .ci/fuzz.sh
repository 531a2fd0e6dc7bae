# Sourced: the function `fuzz`, which is `cargo fuzz` by a compiler that takes the fuzzer's options. Installs what is missing.

cargo fuzz --version >/dev/null 2>&1 || cargo install cargo-fuzz --locked

# Those options are for nightly compilers only; without one, RUSTC_BOOTSTRAP=1 lets the stable compiler take them.
if cargo +nightly --version >/dev/null 2>&1 \
  || { command -v rustup >/dev/null 2>&1 && rustup toolchain install nightly --profile minimal; }; then
  fuzz() { cargo +nightly fuzz "$@"; }
else
  echo "no nightly toolchain, and none could be installed: using the stable compiler with RUSTC_BOOTSTRAP=1"
  fuzz() { RUSTC_BOOTSTRAP=1 cargo fuzz "$@"; }
fi
