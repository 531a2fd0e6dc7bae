"""Mitsuba 3 as a peer of lights with an area: direct light by samples, one point of the light for each.

usage: soft_light.py SCENE SIDE OUT

Takes SIDE² samples a pixel, multi-jittered, on one thread. Writes the picture to OUT as three little-endian floats a pixel, row by row, and prints
"cpu_s SECONDS": building the tree and rendering, without reading, writing and compiling (Mitsuba compiles a kernel for each scene, which a first picture
does here).

SCENE is as for `studies/peers/embree/direct_light.cpp`, with a third kind of light, 2: a rectangle with the corner and the radiance in the place of position and
intensity; after whether it casts shadows come its two edges, x y z each. It sheds light to the side of their cross product.
"""

import sys
import time

import numpy as np

import mitsuba as mi

# Vectorised where Mitsuba finds LLVM, as its users would have it.
try:
    mi.set_variant("llvm_ad_rgb")
    import drjit as dr

    dr.set_thread_count(1)
    dr.eval(dr.arange(mi.Float, 1))
except (ImportError, RuntimeError, AttributeError):
    mi.set_variant("scalar_rgb")


def read(path):
    """The scene as a dictionary for Mitsuba, without its sensor, and what the sensor needs."""
    numbers = iter(open(path).read().split())
    one = lambda: float(next(numbers))
    count = lambda: int(float(next(numbers)))
    vector = lambda: [one(), one(), one()]
    rgb = lambda value: {"type": "rgb", "value": value}

    size = count(), count()
    eye, _right, down, forward = (np.array(vector()) for _ in range(4))
    scale = one()
    background = vector()
    if any(background):
        sys.exit("soft_light: the background must be black")
    scene = {"type": "scene"}
    materials = []
    for _ in range(count()):
        diffuse, emission, opacity = vector(), vector(), one()
        if any(emission) or opacity != 1:
            sys.exit("soft_light: surfaces must be opaque and not glow")
        materials.append({"type": "twosided", "b": {"type": "diffuse", "reflectance": rgb(diffuse)}})
    for i in range(count()):
        kind, place, strength, _shadow = count(), np.array(vector()), vector(), count()
        if kind != 2:
            sys.exit("soft_light: lights must be rectangles")
        u, v = np.array(vector()), np.array(vector())
        normal = np.cross(u, v)
        matrix = np.eye(4)
        # Mitsuba's rectangle reaches from -1 to 1.
        matrix[:3, 0], matrix[:3, 1], matrix[:3, 2] = u / 2, v / 2, normal / np.linalg.norm(normal)
        matrix[:3, 3] = place + (u + v) / 2
        scene[f"light{i}"] = {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f(matrix),
            "emitter": {"type": "area", "radiance": rgb(strength)},
        }
    vertices = np.array([vector() for _ in range(count())])
    triangles = np.array([[count() for _ in range(4)] for _ in range(count())])
    for k, material in enumerate(materials):
        chosen = triangles[triangles[:, 3] == k][:, :3]
        if not len(chosen):
            continue
        properties = mi.Properties()
        properties["mesh_bsdf"] = mi.load_dict(material)
        properties["face_normals"] = True
        corners = vertices[chosen].reshape(-1, 3).astype(np.float32)
        mesh = mi.Mesh(f"material{k}", len(corners), len(chosen), props=properties)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = corners.ravel()
        parameters["faces"] = np.arange(len(corners), dtype=np.uint32)
        parameters.update()
        scene[f"material{k}"] = mesh
    sensor = {
        "type": "perspective",
        "fov": float(np.degrees(2 * np.arctan(size[0] / 2 / scale))),
        "fov_axis": "x",
        "to_world": mi.ScalarTransform4f().look_at(
            origin=eye.tolist(), target=(eye + forward).tolist(), up=(-down).tolist()
        ),
        "film": {
            "type": "hdrfilm",
            "width": size[0],
            "height": size[1],
            "rfilter": {"type": "box"},
            "pixel_format": "rgb",
            "component_format": "float32",
        },
    }
    return scene, sensor


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    path, side, out = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    scene, sensor = read(path)
    sensor["sampler"] = {"type": "multijitter", "sample_count": side * side}
    scene["sensor"] = sensor
    integrator = mi.load_dict({"type": "direct", "emitter_samples": 1, "bsdf_samples": 0, "hide_emitters": True})
    np.array(mi.render(mi.load_dict(scene), integrator=integrator, seed=1))
    start = time.process_time()
    picture = np.array(mi.render(mi.load_dict(scene), integrator=integrator, seed=2))
    seconds = time.process_time() - start
    picture[:, :, :3].astype("<f4").tofile(out)
    print(f"cpu_s {seconds}")


main()
