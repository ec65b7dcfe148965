# A container that runs the experiments (docs/evaluation.md, "In a container").
# The deep check `container` runs these steps in a bare Debian 12.
FROM debian:12
WORKDIR /palpate
COPY . .
RUN scripts/install_packages.sh io && rm -rf /var/lib/apt/lists/*
RUN cmake --preset package -DPALPATE_VIEWER=OFF && cmake --build build/package && cmake --install build/package
WORKDIR /results
ENTRYPOINT ["palpate", "evaluate"]
CMD ["all", "--output", "/results"]
