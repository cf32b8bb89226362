#!/bin/sh
# Install the checkout in $1 into an environment in $2, as root of a container of Debian 12. Both containers do this.
#
#   TORCH_INDEX   address of a package index that has the build of torch you want; without it, pip's own
#   EXTRAS        extras of the package, with commas between them
set -eu
source=$1
environment=$2

# SAPIEN draws with Mesa 24.3 or newer, which Debian 12 has in its backports; a GPU's own driver comes from the host.
sed -i '/^Suites: bookworm /s/$/ bookworm-backports/' /etc/apt/sources.list.d/debian.sources
apt-get update
apt-get install --yes --no-install-recommends ca-certificates python3 python3-venv libegl1 libx11-6 libxext6
apt-get install --yes --no-install-recommends --target-release bookworm-backports mesa-vulkan-drivers

python3 -m venv "$environment"
pip() { "$environment/bin/python" -m pip --disable-pip-version-check --no-cache-dir "$@"; }
pip install ${TORCH_INDEX:+--index-url "$TORCH_INDEX"} torch==2.13.0
pip install "$source${EXTRAS:+[$EXTRAS]}"
for part in opencv cvvdp efficientnet; do
  "$environment/bin/vcage" setup "$part"
done

rm -rf /var/lib/apt/lists/*
