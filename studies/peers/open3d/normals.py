"""Open3D as a peer of estimated normals: a plane through so many neighbours of each point, and one side for all of a surface.

usage: normals.py POINTS NEIGHBOURS OUT

POINTS is a text: 1 if sides are wanted, else 0, then three numbers for each point. Writes a unit normal for each to OUT, three little-endian floats, and
prints "cpu_s SECONDS", on one thread, without reading and writing.
"""

import os
import sys
import time

# Read when the libraries are loaded.
os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np
import open3d as o3d


def main():
    points, neighbours, out = sys.argv[1], int(sys.argv[2]), sys.argv[3]
    with open(points) as file:
        sided = int(next(file))
        places = np.loadtxt(file)
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(places))
    start = time.process_time()
    cloud.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(neighbours))
    if sided:
        cloud.orient_normals_consistent_tangent_plane(neighbours)
    seconds = time.process_time() - start
    np.asarray(cloud.normals).astype("<f4").tofile(out)
    print("cpu_s", seconds)


main()
