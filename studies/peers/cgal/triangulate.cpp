// CGAL as a peer of `pointillist-delaunay`: what building a Delaunay triangulation takes, and finding positions in it.
//
// usage: triangulate POINTS [QUERIES]
//
// Both files hold x, y, z of each point as little-endian doubles. Printed are words with their numbers, for `studies/src/shprobe/peer.rs`. Of
// several builds the fastest counts, as for the crate. Queries are found on one thread, from scratch; then positions along a curve
// through the points' box, each from the cell of the one before.
//
// With -DFAST positions are found through a hierarchy of triangulations (CGAL's Fast_location).

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <memory>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
#ifdef FAST
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Fast_location>;
#else
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel>;
#endif

static double seconds(clockid_t clock) {
    timespec time;
    clock_gettime(clock, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

static std::vector<Point> read_points(const char* path) {
    std::FILE* file = std::fopen(path, "rb");
    if (!file) {
        std::fprintf(stderr, "%s cannot be read\n", path);
        std::exit(1);
    }
    std::vector<Point> points;
    double at[3];
    while (std::fread(at, sizeof at, 1, file) == 1) points.emplace_back(at[0], at[1], at[2]);
    std::fclose(file);
    return points;
}

// As many builds as the crate gets: small sets vary most.
static int builds_for(std::size_t count) {
    return count <= 1000 ? 21 : count <= 20000 ? 5 : count <= 200000 ? 2 : 1;
}

// Millions of positions a processor second that `find` finds.
template <class Find>
static double rate(std::size_t count, Find find) {
    const double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (std::size_t i = 0; i < count; ++i) find(i);
    return double(count) / (seconds(CLOCK_PROCESS_CPUTIME_ID) - start) / 1e6;
}

// The curve that `studies/src/shprobe/delaunay.rs` follows, through the unit cube.
static Point on_curve(std::size_t i, std::size_t count) {
    const double f = 2.0 * M_PI * double(i) / double(count);
    return {0.5 + 0.45 * std::sin(3.0 * f), 0.5 + 0.45 * std::cos(5.0 * f), 0.5 + 0.45 * std::sin(7.0 * f + 1.0)};
}

int main(int count, char** arguments) {
    if (count < 2) {
        std::fprintf(stderr, "usage: triangulate POINTS [QUERIES]\n");
        return 2;
    }
    const std::vector<Point> points = read_points(arguments[1]);
    double wall = std::numeric_limits<double>::infinity(), cpu = wall;
    std::unique_ptr<Triangulation> built;
    for (int run = builds_for(points.size()); run > 0; --run) {
        built.reset();
        const double wall_start = seconds(CLOCK_MONOTONIC), cpu_start = seconds(CLOCK_PROCESS_CPUTIME_ID);
        built = std::make_unique<Triangulation>(points.begin(), points.end());
        wall = std::min(wall, seconds(CLOCK_MONOTONIC) - wall_start);
        cpu = std::min(cpu, seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_start);
    }
    std::printf("build_s %.6f cpu_s %.6f cells %zu", wall, cpu, std::size_t(built->number_of_finite_cells()));
    if (count > 2 && built->dimension() == 3) {
        const std::vector<Point> queries = read_points(arguments[2]);
        // Summed up, so that no search can be left out.
        std::size_t outside = 0;
        const double anywhere = rate(queries.size(), [&](std::size_t i) {
            outside += built->is_infinite(built->locate(queries[i]));
        });
        Triangulation::Cell_handle last = built->finite_cells_begin();
        const double along = rate(queries.size(), [&](std::size_t i) {
            last = built->locate(on_curve(i, queries.size()), last);
            outside += built->is_infinite(last);
        });
        std::printf(" locate_random_Mqps %.4f locate_coherent_Mqps %.4f outside %zu", anywhere, along, outside);
    }
    std::printf("\n");
}
