# e2lf in a Debian container, for Docker, Podman or Buildah.
#   docker build -t e2lf . && docker run --rm -v "$PWD/out:/out" e2lf demo -o /out/demo
FROM debian:12-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends \
    g++ cmake ninja-build pkg-config dpkg-dev file \
    libhwy-dev libhdf5-dev libpng-dev libjpeg62-turbo-dev zlib1g-dev liblz4-dev libzstd-dev libsqlite3-dev libeigen3-dev \
    nlohmann-json3-dev libcli11-dev pybind11-dev python3-dev python3-numpy
COPY . /e2lf
WORKDIR /e2lf
RUN cmake --preset release -DE2LF_WITH_TORCH=OFF -DE2LF_WITH_VIEWER=OFF && cmake --build build/release && cd build/release && cpack -G DEB

FROM debian:12-slim
COPY --from=build /e2lf/build/release/e2lf_*.deb /e2lf/build/release/python3-e2lf_*.deb /packages/
RUN apt-get update && apt-get install -y --no-install-recommends /packages/*.deb && rm -rf /packages /var/lib/apt/lists/*
WORKDIR /out
ENTRYPOINT ["e2lf"]
CMD ["demo", "-o", "/out/demo", "--overwrite"]
