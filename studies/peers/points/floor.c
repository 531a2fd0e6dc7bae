/* A frame of range scans as fast as plain C does it: the least that the method of `ibpr` needs, on one thread, as a ruler for its time.
 *
 *   floor SCENE FRAMES PICTURE    draws SCENE so many times, prints `cpu_s` with the median of their processor seconds, writes the last as RGB floats
 *
 * SCENE is text: width height, S, gamma, step; eye, right, down, forward of the camera; pixels per unit at depth 1; the direction towards the light, the
 * ambient share and the albedo; the number of points and their coordinates.
 *
 * 1 nearest depth of each pixel of a buffer of width/S; 2 sums of all points within gamma of it; 3 means; 4 normals from the eight triangles with neighbours no
 * farther than a step, and light; 5 faces of two triangles between four means, of one between three, drawn at full size; 6 colour and depth of every pixel.
 * No outlines (surfaces end at their outermost means), no gaps filled, no blocks skipped, no checks of the input beyond its length. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BLOCK = 1024 };

typedef struct { float x, y, z, count; } Mean;          /* sums, then means, in buffer pixels and depth */
typedef struct { float x, y, z, shade; } Corner;        /* in picture pixels */
typedef struct { float eye[3], axes[9], focal, light[3], ambient, albedo; } Camera;

static int width, height, columns, rows;
static float S, gamma_, step_;
static Camera cam;
static float *px, *py, *pz, *nearest, *depth, *shade, *out_color, *out_depth;
static Mean *means;
static Corner *corners;
static float bx[BLOCK], by[BLOCK], bz[BLOCK];
static int at[BLOCK];

static void *zeroed(size_t n, size_t size) {
    void *p = calloc(n, size);
    if (!p) { fputs("no memory\n", stderr); exit(1); }
    return p;
}

static double cpu(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

/* Buffer pixels and depths of a block; at is -1 for points outside. */
static void project(int from, int n) {
    const float *a = cam.axes, f = cam.focal / S, cx = 0.5f * width / S, cy = 0.5f * height / S;
    for (int i = 0; i < n; i++) {
        float x = px[from + i] - cam.eye[0], y = py[from + i] - cam.eye[1], z = pz[from + i] - cam.eye[2];
        float d = a[6] * x + a[7] * y + a[8] * z, k = f / d;
        bx[i] = (a[0] * x + a[1] * y + a[2] * z) * k + cx;
        by[i] = (a[3] * x + a[4] * y + a[5] * z) * k + cy;
        bz[i] = d;
    }
    for (int i = 0; i < n; i++) {
        int inside = (bz[i] > 0) & (bx[i] >= 0) & (by[i] >= 0) & (bx[i] < columns) & (by[i] < rows);
        at[i] = inside ? (int)by[i] * columns + (int)bx[i] : -1;
    }
}

/* Steps 1 and 2. */
static void accumulate(int points) {
    int pixels = columns * rows;
    for (int i = 0; i < pixels; i++) nearest[i] = INFINITY;
    memset(means, 0, pixels * sizeof *means);
    for (int pass = 0; pass < 2; pass++)
        for (int from = 0; from < points; from += BLOCK) {
            int n = points - from < BLOCK ? points - from : BLOCK;
            project(from, n);
            for (int i = 0; i < n; i++) {
                int p = at[i];
                if (p < 0) continue;
                if (pass == 0) {
                    if (bz[i] < nearest[p]) nearest[p] = bz[i];
                } else if (bz[i] <= nearest[p] + gamma_) {
                    Mean *m = &means[p];
                    m->x += bx[i]; m->y += by[i]; m->z += bz[i]; m->count += 1;
                }
            }
        }
}

/* Step 3. Empty pixels have an infinite depth. */
static void resolve(void) {
    for (int i = 0; i < columns * rows; i++) {
        Mean *m = &means[i];
        float k = m->count > 0 ? 1 / m->count : 0;
        corners[i].x = m->x * k * S;
        corners[i].y = m->y * k * S;
        corners[i].z = m->count > 0 ? m->z * k : INFINITY;
    }
}

/* Step 4. */
static void light(void) {
    static const int dx[9] = {1, 1, 0, -1, -1, -1, 0, 1, 1}, dy[9] = {0, 1, 1, 1, 0, -1, -1, -1, 0};
    float k = 1 / cam.focal, cx = 0.5f * width, cy = 0.5f * height;
    for (int y = 1; y < rows - 1; y++)
        for (int x = 1; x < columns - 1; x++) {
            Corner *c = &corners[y * columns + x];
            if (c->z == INFINITY) continue;
            float ox = (c->x - cx) * c->z * k, oy = (c->y - cy) * c->z * k, n[3] = {0, 0, 0}, before[3];
            int joined = 0;
            for (int i = 0; i < 9; i++) {
                const Corner *o = &corners[(y + dy[i]) * columns + x + dx[i]];
                if (!(fabsf(o->z - c->z) < step_)) { joined = 0; continue; }
                float v[3] = {(o->x - cx) * o->z * k - ox, (o->y - cy) * o->z * k - oy, o->z - c->z};
                if (joined) {
                    n[0] += before[1] * v[2] - before[2] * v[1];
                    n[1] += before[2] * v[0] - before[0] * v[2];
                    n[2] += before[0] * v[1] - before[1] * v[0];
                }
                memcpy(before, v, sizeof v);
                joined = 1;
            }
            /* Right and then down turn away from the eye: depth grows along the sum. */
            float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            float facing = length > 0 ? -(n[0] * cam.light[0] + n[1] * cam.light[1] + n[2] * cam.light[2]) / length : 0;
            c->shade = cam.albedo * (cam.ambient + (1 - cam.ambient) * (facing > 0 ? facing : 0));
        }
}

static int least(float a, float b, float c) { float v = a < b ? a : b; v = v < c ? v : c; return (int)ceilf(v - 0.5f); }
static int most(float a, float b, float c) { float v = a > b ? a : b; v = v > c ? v : c; return (int)floorf(v - 0.5f); }

/* Depth and light are planes over the picture. */
static void triangle(const Corner *a, const Corner *b, const Corner *c) {
    float area = (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
    if (area == 0) return;
    int left = least(a->x, b->x, c->x), right = most(a->x, b->x, c->x);
    int top = least(a->y, b->y, c->y), bottom = most(a->y, b->y, c->y);
    if (left < 0) left = 0;
    if (top < 0) top = 0;
    if (right >= width) right = width - 1;
    if (bottom >= height) bottom = height - 1;
    float k = 1 / area;
    for (int y = top; y <= bottom; y++)
        for (int x = left; x <= right; x++) {
            float u = x + 0.5f - a->x, v = y + 0.5f - a->y;
            float q = (u * (c->y - a->y) - v * (c->x - a->x)) * k, r = (v * (b->x - a->x) - u * (b->y - a->y)) * k;
            if (q < 0 || r < 0 || q + r > 1) continue;
            float z = a->z + q * (b->z - a->z) + r * (c->z - a->z);
            int i = y * width + x;
            if (z < depth[i]) {
                depth[i] = z;
                shade[i] = a->shade + q * (b->shade - a->shade) + r * (c->shade - a->shade);
            }
        }
}

/* Step 5. */
static void faces(void) {
    for (int i = 0; i < width * height; i++) depth[i] = INFINITY;
    for (int y = 0; y < rows - 1; y++)
        for (int x = 0; x < columns - 1; x++) {
            const Corner *quad[4] = {&corners[y * columns + x], &corners[y * columns + x + 1],
                                     &corners[(y + 1) * columns + x + 1], &corners[(y + 1) * columns + x]};
            const Corner *kept[4];
            float low = INFINITY, high = 0;
            int n = 0;
            for (int i = 0; i < 4; i++) {
                if (quad[i]->z == INFINITY) continue;
                low = quad[i]->z < low ? quad[i]->z : low;
                high = quad[i]->z > high ? quad[i]->z : high;
                kept[n++] = quad[i];
            }
            if (n < 3 || high - low >= step_) continue;
            triangle(kept[0], kept[1], kept[2]);
            if (n == 4) triangle(kept[0], kept[2], kept[3]);
        }
}

/* Step 6. */
static void write_pixels(void) {
    for (int i = 0; i < width * height; i++) {
        int is_there = depth[i] < INFINITY;
        float value = is_there ? shade[i] : 0;
        out_color[4 * i] = out_color[4 * i + 1] = out_color[4 * i + 2] = value;
        out_color[4 * i + 3] = is_there;
        out_depth[i] = depth[i];
    }
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static float number(FILE *file) {
    double value;
    if (fscanf(file, "%lf", &value) != 1) { fputs("the scene ends early\n", stderr); exit(1); }
    return (float)value;
}

int main(int count, char **words) {
    FILE *file = count == 4 ? fopen(words[1], "r") : NULL;
    int frames = count == 4 ? atoi(words[2]) : 0;
    if (!file || frames < 1) { fputs("floor SCENE FRAMES PICTURE\n", stderr); return 1; }
    width = (int)number(file); height = (int)number(file);
    S = number(file); gamma_ = number(file); step_ = number(file);
    for (int i = 0; i < 3; i++) cam.eye[i] = number(file);
    for (int i = 0; i < 9; i++) cam.axes[i] = number(file);
    cam.focal = number(file);
    float towards[3];
    for (int i = 0; i < 3; i++) towards[i] = number(file);
    for (int i = 0; i < 3; i++)
        cam.light[i] = cam.axes[3 * i] * towards[0] + cam.axes[3 * i + 1] * towards[1] + cam.axes[3 * i + 2] * towards[2];
    cam.ambient = number(file); cam.albedo = number(file);
    int points = (int)number(file);
    columns = (int)ceilf(width / S); rows = (int)ceilf(height / S);
    px = zeroed(points, 4); py = zeroed(points, 4); pz = zeroed(points, 4);
    for (int i = 0; i < points; i++) { px[i] = number(file); py[i] = number(file); pz[i] = number(file); }
    fclose(file);
    nearest = zeroed(columns * rows, sizeof *nearest); means = zeroed(columns * rows, sizeof *means);
    corners = zeroed(columns * rows, sizeof *corners);
    depth = zeroed(width * height, 4); shade = zeroed(width * height, 4);
    out_color = zeroed(width * height, 16); out_depth = zeroed(width * height, 4);
    double *seconds = zeroed(frames, sizeof *seconds);
    for (int i = 0; i < frames; i++) {
        double start = cpu();
        accumulate(points); resolve(); light(); faces(); write_pixels();
        seconds[i] = cpu() - start;
    }
    qsort(seconds, frames, sizeof *seconds, by_value);
    printf("cpu_s %.9f\n", seconds[frames / 2]);
    FILE *picture = fopen(words[3], "wb");
    if (!picture) { fputs("the picture cannot be written\n", stderr); return 1; }
    for (int i = 0; i < width * height; i++) fwrite(&out_color[4 * i], 4, 3, picture);
    return fclose(picture) != 0;
}
