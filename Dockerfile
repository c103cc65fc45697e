# Waymark in a container: one static binary on busybox, no root, nothing written outside its two volumes.
#
#   docker build -t waymark .                                   compiles
#   docker build -t waymark --target prebuilt -f Dockerfile DIR takes DIR/waymark, a static binary already built:
#       RUSTFLAGS='-C target-feature=+crt-static' cargo build --release -p waymark --target x86_64-unknown-linux-gnu
#
# Docker's older builder builds every stage up to its target. So the stage that compiles comes after `prebuilt`, and
# `prebuilt` takes a binary only where there is one: brackets make a name a pattern, which may match nothing.

FROM busybox:1.36 AS base
# Volumes take over these directories with their owner. 65532 is the number that images without users agree on.
RUN mkdir -p /var/lib/waymark /recordings && chown 65532:65532 /var/lib/waymark /recordings
USER 65532:65532
WORKDIR /var/lib/waymark
VOLUME ["/var/lib/waymark", "/recordings"]
STOPSIGNAL SIGTERM
ENTRYPOINT ["/usr/local/bin/waymark"]
CMD ["--help"]

FROM base AS prebuilt
COPY Cargo.tom[l] waymar[k] /usr/local/bin/

FROM rust:1.95-slim-bookworm AS build
# zstd and ring are C and assembly, the H.264 codec C++ and assembly. npm brings uPlot, from which the page's plots have
# their axes; it comes with Node, and the build does without both.
RUN apt-get update \
 && apt-get install -y --no-install-recommends gcc g++ libc6-dev make nasm npm \
 && rm -rf /var/lib/apt/lists/*
WORKDIR /source
COPY . .
# --target keeps the flag from build scripts and procedural macros, which cannot be static.
RUN target=$(rustc -vV | sed -n 's/^host: //p') \
 && CARGO_PROFILE_RELEASE_STRIP=symbols RUSTFLAGS="-C target-feature=+crt-static" \
    cargo build --release --locked -p waymark --target "$target" \
 && install -Ds "target/$target/release/waymark" /out/waymark

FROM base
COPY --from=build /out/waymark /usr/local/bin/waymark
