#!/usr/bin/env python3
"""The scene `bumpy-ball:N` in Mitsuba 3 (Jakob et al. 2022), for a comparison of the time to equal RMSE on a mesh.

    experiments/peers/mitsuba_ball.py N SIZE SPP SEED OUT.pfm

N triangles at least, as in experiments/scenes/bumpy-ball.toml; needs `pip install mitsuba numpy`. One thread renders, with
the integrator `path`. MITSUBA_VARIANT=llvm_ad_rgb is faster and needs LLVM (Debian's libllvm19, named by
DRJIT_LIBLLVM_PATH; 15 cannot compile it). Prints `seconds = ...` of a second rendering, after the first has compiled its
kernels, and writes that image, of SEED + 1.
"""

import math
import os
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant(os.environ.get("MITSUBA_VARIANT", "scalar_rgb"))
dr.set_thread_count(1)

wanted, size, spp, seed, out = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]), sys.argv[5]


def ball(wanted):
    bands = math.ceil(0.5 + 0.5 * math.sqrt(1 + wanted))
    down = math.pi / bands * np.arange(bands + 1)[:, None]
    around = math.pi / bands * np.arange(2 * bands)[None, :]
    ring = np.sin(down)
    ring[0] = ring[-1] = 0
    radius = 0.6 * (1 + 0.08 * ring * np.sin(9 * down) * np.sin(8 * around))
    points = np.stack([ring * np.cos(around), np.cos(down) + 0 * around, ring * np.sin(around)], -1) * radius[..., None]
    i, j = np.meshgrid(np.arange(bands), np.arange(2 * bands), indexing="ij")
    k = lambda i, j: i * 2 * bands + j % (2 * bands)
    a, b, c, d = k(i, j), k(i + 1, j), k(i + 1, j + 1), k(i, j + 1)
    lower = np.stack([a, c, b], -1)[:-1].reshape(-1, 3)
    upper = np.stack([a, d, c], -1)[1:].reshape(-1, 3)
    return points.reshape(-1, 3), np.concatenate([lower, upper])


def diffuse(*albedo):
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(albedo)}}}


points, faces = ball(wanted)
properties = mi.Properties()
properties["bsdf"] = mi.load_dict(diffuse(0.6, 0.65, 0.7))
mesh = mi.Mesh("ball", len(points), len(faces), props=properties)
parameters = mi.traverse(mesh)
parameters["vertex_positions"] = points.astype(np.float32).ravel()
parameters["faces"] = faces.astype(np.uint32).ravel()
parameters.update()

T = mi.ScalarTransform4f


def wall(albedo, to_world, **more):
    return {"type": "rectangle", "to_world": to_world, "bsdf": diffuse(*albedo), **more}


lamp = {"type": "area", "radiance": {"type": "rgb", "value": [12.0, 12.0, 11.0]}}
scene = mi.load_dict({
    "type": "scene",
    "integrator": {"type": "path", "max_depth": -1, "rr_depth": 5},
    "sensor": {
        "type": "perspective",
        "fov": 36.0,
        "to_world": T().look_at([0, 0, 4.2], [0, 0, 0], [0, 1, 0]),
        "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
        "sampler": {"type": "independent"},
    },
    "ball": mesh,
    "floor": wall([0.7] * 3, T().translate([0, -1, 0]).rotate([1, 0, 0], -90)),
    "ceiling": wall([0.7] * 3, T().translate([0, 1, 0]).rotate([1, 0, 0], 90)),
    "back": wall([0.7] * 3, T().translate([0, 0, -1])),
    "left": wall([0.7, 0.25, 0.2], T().translate([-1, 0, 0]).rotate([0, 1, 0], 90)),
    "right": wall([0.25, 0.45, 0.7], T().translate([1, 0, 0]).rotate([0, 1, 0], -90)),
    # A lamp emits on both sides in Pathmark, and on one side in Mitsuba.
    "below": wall([0.0] * 3, T().translate([0, 0.9, 0]).rotate([1, 0, 0], 90).scale([0.3, 0.3, 1]), emitter=lamp),
    "above": wall([0.0] * 3, T().translate([0, 0.9001, 0]).rotate([1, 0, 0], -90).scale([0.3, 0.3, 1]), emitter=lamp),
})


def render(seed):
    image = mi.render(scene, spp=spp, seed=seed)
    dr.eval(image)
    dr.sync_thread()
    return image


render(seed)
begin = time.perf_counter()
image = render(seed + 1)
print(f"seconds = {time.perf_counter() - begin:.4f}")
mi.Bitmap(image).write(out)
