#!/usr/bin/env bash
# wheel_elsewhere.sh WHEEL FOLDER: runs the wheel for other distributions in a root of Debian 13, made in FOLDER, with nothing but
# the Python and the numpy that it is for, which are those of Debian 12. Needs root and mmdebstrap.
set -euo pipefail
wheel=$(realpath "$1") folder=$2 root=$2/root
mirror=$(apt-get indextargets --format '$(REPO_URI) $(CODENAME)' "Created-By: Packages" | sed -n '0,/ bookworm$/s/ bookworm$//p')
rm -rf "$folder"
mkdir -p "$folder/packages"
mmdebstrap --quiet --variant=extract \
  --include=base-files,libc6,libc-bin,libstdc++6,libgcc-s1,zlib1g,libexpat1,libffi8,libbz2-1.0,liblzma5,libblas3,liblapack3 trixie "$root" "$mirror"
(cd "$folder/packages" && apt-get -o APT::Sandbox::User=root download -qq python3.11-minimal libpython3.11-minimal libpython3.11-stdlib python3-numpy)
for package in "$folder"/packages/*.deb; do dpkg -x "$package" "$root"; done
printf '/usr/lib/x86_64-linux-gnu/%s\n' blas lapack >"$root/etc/ld.so.conf.d/blas.conf"
chroot "$root" ldconfig
# As pip installs it.
python3 -m zipfile -e "$wheel" "$folder/wheel"
cp -r "$folder/wheel/e2lf" "$root/usr/lib/python3/dist-packages/"
cp -r "$folder"/wheel/e2lf-*.data/data/share/e2lf "$root/usr/share/"
env -i PATH=/usr/sbin:/usr/bin chroot "$root" /usr/bin/python3.11 - <<'PY'
import os
import numpy as np
import e2lf
os.chdir("/tmp")
scene = e2lf.demo_scene(96, 64)
model = e2lf.Model("e2lf-n4")
images = e2lf.simulate(scene, model.codes, constants=model.constants)
field = e2lf.Reconstructor(model).reconstruct(images)
assert e2lf.psnr(np.clip(field, 0, 1), scene) > 15
assert e2lf.Reconstructor("e2lf-n4-geometry").reconstruct(images).shape == field.shape
assert e2lf.Reconstructor("e2lf-n4-depth").depth(images).disparity.shape == (64, 96)
e2lf.write_light_field("views", field)
assert e2lf.read_light_field("views").shape == field.shape
events = np.zeros(1000, dtype=[("x", "<u2"), ("y", "<u2"), ("p", "<i2"), ("t", "<i8")])
events["t"], events["x"] = np.arange(1000), np.arange(1000) % 90
for name in ("a.raw", "a.hdf5", "a.npz", "a.csv", "a.dat"):
    with e2lf.create_recording(name, sensor_width=96, sensor_height=64) as writer:
        writer.write(events)
    read, _ = e2lf.read_events(name)
    assert all((read[field] == events[field]).all() for field in ("x", "y", "p", "t")), name
print("wheel: runs on Debian", open("/etc/debian_version").read().strip())
PY
