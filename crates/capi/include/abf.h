/* Angle-based flattening of triangle meshes. Written by cbindgen from crates/capi; do not edit.
 *
 * Every function may be called from any thread, and none throws or unwinds. A result belongs to the caller, who frees it once.
 * Where a function takes an array, it must be as long as its count says, and stay unchanged while the function runs.
 * When the system has no memory left, the process ends: set `max_memory` to be refused before. */

#ifndef ABF_H
#define ABF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// What a callback returns to go on.
#define ABF_CONTINUE 0

// What a callback returns to stop with the best result so far. Every other number aborts without one.
#define ABF_STOP 1

// What a callback returns to abort without a result.
#define ABF_ABORT 2

// What `margin` is for charts that may touch.
#define ABF_NO_MARGIN UINT32_MAX

// What became of a call. Codes are never renumbered; `abf_last_error` has the sentence.
typedef enum AbfStatus {
  // There is a result. Its view says whether it is valid.
  ABF_STATUS_OK = 0,
  // A pointer that is null and may not be, or is not aligned to what it points to.
  ABF_STATUS_POINTER = 1,
  // A `size` field that is not the size of a struct that this version of the library knows.
  ABF_STATUS_STRUCT_SIZE = 2,
  // Counts whose arrays cannot exist, or have more elements than 32-bit indices can name.
  ABF_STATUS_TOO_LARGE = 3,
  // A stride below 12 bytes, or not a multiple of 4.
  ABF_STATUS_STRIDE = 4,
  // A number of indices that is not a multiple of 3.
  ABF_STATUS_INDEX_COUNT = 5,
  // An index without a vertex.
  ABF_STATUS_INDEX_RANGE = 6,
  // A coordinate that is NaN or infinite.
  ABF_STATUS_NOT_FINITE = 7,
  // A setting out of range, or a name that nothing has.
  ABF_STATUS_SETTING = 8,
  // The mesh is not a disk: `abf_unwrap` takes it.
  ABF_STATUS_NOT_A_DISK = 9,
  // No faces, or faces that form no oriented manifold: `abf_unwrap` repairs those.
  ABF_STATUS_TOPOLOGY = 10,
  // Faces without area.
  ABF_STATUS_GEOMETRY = 11,
  // The mesh needs repair, and `strict` was set.
  ABF_STATUS_NOT_CLEAN = 12,
  // It would take more memory than `max_memory`; none of it was taken.
  ABF_STATUS_MEMORY = 13,
  // The callback aborted, or stopped before there was anything to return.
  ABF_STATUS_CANCELLED = 14,
  // No solver found a map.
  ABF_STATUS_NO_RESULT = 15,
  // The charts do not fit into the atlas.
  ABF_STATUS_PACKING = 16,
  // The system gives no threads.
  ABF_STATUS_THREADS = 17,
  // A defect of the library. Please report it with the sentence.
  ABF_STATUS_INTERNAL = 18,
} AbfStatus;

// What has happened.
typedef enum AbfEventKind {
  // Work goes on. Told between blocks of long work, so that it can be interrupted there.
  ABF_EVENT_KIND_WORKING = 0,
  // A stage begins: `stage`.
  ABF_EVENT_KIND_STAGE = 1,
  // The next solver of "auto" begins: `solver`.
  ABF_EVENT_KIND_SOLVER = 2,
  // An outer iteration, or a pass of Linear ABF, is done: `iteration`, `residual`.
  ABF_EVENT_KIND_ITERATION = 3,
  // An inner iteration is done: `iteration`, `inner`, `residual`.
  ABF_EVENT_KIND_INNER = 4,
} AbfEventKind;

// The parts of flattening a disk, in their order.
typedef enum AbfStage {
  // Corner table, disk check, angles of the surface.
  ABF_STAGE_TOPOLOGY = 0,
  // Solving for the angles.
  ABF_STAGE_SOLVE = 1,
  // From angles to coordinates.
  ABF_STAGE_LAYOUT = 2,
  // From coordinates to what is proved of them.
  ABF_STAGE_CERTIFICATE = 3,
  // After the layout: to the least of an energy, or to pins.
  ABF_STAGE_RELAX = 4,
} AbfStage;

// How the solver ended. Of an atlas: the first end that was not as asked, if there is one.
typedef enum AbfTermination {
  // The stopping criteria are met.
  ABF_TERMINATION_CONVERGED = 0,
  // The one pass, or the one linear solve, that was asked for is done.
  ABF_TERMINATION_ONE_PASS = 1,
  // The largest number of iterations is done.
  ABF_TERMINATION_MAX_ITERATIONS = 2,
  // The time is up.
  ABF_TERMINATION_TIME_LIMIT = 3,
  // The residual stopped falling.
  ABF_TERMINATION_STALLED = 4,
  // The callback stopped it.
  ABF_TERMINATION_CANCELLED = 5,
} AbfTermination;

// A result.
typedef struct AbfResult AbfResult;

// What a callback is told. Later versions append fields.
typedef struct AbfEvent {
  // What has happened.
  enum AbfEventKind kind;
  // The stage that runs.
  enum AbfStage stage;
  // The solver that begins, else null. Valid during the call.
  const char *solver;
  // Outer iterations are counted from 1.
  uint32_t iteration;
  // Inner iterations of it that are done.
  uint32_t inner;
  // Of an outer iteration `max |h|`, rad; of an inner one its estimate of the relative residual, NaN where it has none.
  double residual;
  // `abf_unwrap`: which connected component, and how many there are.
  uint32_t component;
  // See `component`.
  uint32_t components;
  // `abf_unwrap`: faces of all components, and how many of them are in finished charts.
  uint32_t faces;
  // See `faces`.
  uint32_t faces_done;
  // `abf_unwrap`: the round of flattening and cutting, counted from 0.
  uint32_t round;
} AbfEvent;

// Called on a thread that works, for one call of the library never by two threads at once. It returns `ABF_CONTINUE`,
// `ABF_STOP` or `ABF_ABORT`, and must neither throw nor unwind.
typedef int32_t (*AbfProgress)(void *user, const struct AbfEvent *event);

// Settings. Fill it with zeros, set `size`, then what differs: 0 and null mean the default. Names are those of the
// program's options.
typedef struct AbfOptions {
  // `sizeof(AbfOptions)`. Later versions append fields, and take what was compiled with less of them.
  size_t size;
  // "auto", "linabf", "abf", "abf++", "abf-newton", "abf-fixed-target", "uzawa", "minres", "barrier", "descent",
  // "habf++", "hlinabf", "lscm".
  const char *solver;
  // "auto", "least-squares", "least-squares-weighted", "tree", "poisson".
  const char *layout;
  // Converged means a constraint residual of at most this, rad; 0: 1e-8.
  double tolerance;
  // And a last step of at most this, rad, where an energy is minimised; 0: 1e-7.
  double step_tolerance;
  // Seconds; 0: no limit. When the time is up, the result is the best so far.
  double time_limit;
  // Bytes; 0: no limit. A mesh for which more is predicted is refused; `abf_unwrap` asks for every flattening.
  // In a browser 0 stands for what is left of 4 GB.
  uint64_t max_memory;
  // Outer iterations or passes; 0: 50.
  uint32_t max_iterations;
  // Threads of a pool for this call alone; 0: one pool for all calls, with a thread per processor.
  uint32_t threads;
  // `abf_flatten`: 1 scales into the unit square; 0 keeps the area of the surface.
  int32_t normalize;
  // `abf_unwrap`: 1 refuses a mesh that needs repair.
  int32_t strict;
  // `abf_unwrap`: 1 leaves a mesh whole that is one disk; 0 cuts it, too, where it misses the stretch.
  int32_t keep_disks;
  // `abf_unwrap`: texels between charts; 0: 2; `ABF_NO_MARGIN`: none.
  uint32_t margin;
  // `abf_unwrap`: texels along x; 0: 1024.
  uint32_t width;
  // `abf_unwrap`: texels along y; 0: as many as along x.
  uint32_t height;
  // `abf_unwrap`: pages that charts may take; 0: 1.
  uint32_t max_pages;
  // 0. It keeps the next field where it is.
  uint32_t reserved;
  // `abf_unwrap`: seams grow until the L² stretch of every chart is at most this; 0: 1.15.
  double max_stretch;
  // `abf_unwrap`: edges that turn by at most this are smooth, rad; 0: π/6.
  double crease_angle;
  // `abf_unwrap`: longer charts are parted, in widths of a page; 0: 4; infinite: none.
  double max_chart_length;
  // `abf_unwrap`: texels per unit of the mesh; 0: as many as fit.
  double texels_per_unit;
  // `abf_unwrap`: which vertices are joined: "auto", "off", or a distance.
  const char *weld;
  // `abf_unwrap`: what becomes of holes: "auto", "fill", "fill-fan", "fill-ears", "cut", "free".
  const char *holes;
  // `abf_unwrap`: room for faces with the same vertices: "own", "shared".
  const char *double_sided;
  // `abf_unwrap`: how hard the packer tries: "fast", "good", "best".
  const char *pack;
  // Told what happens; may be null.
  AbfProgress progress;
  // Handed to it.
  void *user;
  // What becomes of faces without area: "carry", "refuse".
  const char *zero_area;
  // `abf_flatten`: what the boundary is to be: "free", "convex", "below-2pi[=EPS]", "rectangle[=v0,v1,v2,v3]", "circle".
  const char *boundary;
  // `abf_flatten`: or the angles of these vertices of the boundary, `boundary_count` of them; null: none.
  const uint32_t *boundary_vertices;
  // As many angles, rad.
  const double *boundary_angles;
  // How many there are.
  size_t boundary_count;
  // "linabf": no angle moves in a pass by more than this part of its way to 0 or π; 0: no bound.
  double error_bound;
  // "auto", "barrier", "descent": the last weight of the barrier, in units of energy per corner; 0: 0.001.
  double barrier_floor;
  // Rings whose angle deficit is above this start from their target angles, rad; 0: 1; infinite: none does.
  double ring_switch;
  // Angles start from at least this and at most π less this, rad; 0: 0.001.
  double angle_bound;
  // "uzawa", "minres": inner iterations go to this relative residual; 0: it follows the constraint residual.
  double inner_tolerance;
  // "uzawa", "minres": inner iterations in an outer one, at most; 0: 20000.
  uint32_t max_inner_iterations;
  // "auto", "linabf": passes to make; 0: until the constraints are met.
  uint32_t passes;
  // Solvers with a fixed target: the wheel condition, "product" or "log".
  const char *wheel;
  // Those: second derivatives, "exact" or "gauss-newton".
  const char *hessian;
  // Those: "merit" shortens steps until a merit function falls, "full" does not.
  const char *line_search;
  // "uzawa", "minres": which unknowns are eliminated first, "none" or "triangles".
  const char *reduction;
  // "uzawa", "minres": "none", "jacobi", "block".
  const char *preconditioner;
  // `abf_unwrap`: part the largest chart where that lets charts cover more, until they cover this part of the pages; 0: no.
  double coverage;
  // `abf_unwrap`: by which part of their length seams may grow for that; 0: 0.25.
  double seam_budget;
  // `abf_unwrap`: charts that come nearer to themselves than the margin: "count" leaves them, "keep" parts them there.
  const char *inner_margin;
  // `abf_unwrap`: seams grow until they are so long at most, as a multiple of the diagonal of their component; 0: no limit.
  double max_seam;
  // `abf_unwrap`: which charts share a page: "one", "per-component", "per-material".
  const char *atlas;
  // `abf_unwrap`: sets the margin to what mip levels up to this one need, 2 · 2^level texels; 0: `margin` counts.
  uint32_t mip_levels;
  // 0. It keeps the next field where it is.
  uint32_t reserved2;
  // `abf_unwrap`: whether a map that lies over itself is `certified`: "refuse", "allow".
  const char *overlap;
  // `abf_unwrap`: where charts end: "auto": where the map stretches; "keep": at `seam_vertices`, at the seams of `uv` and where
  // `materials` change, and what they leave is cut only as far as is needed. Null: "keep" where `seam_vertices` are given,
  // or pages are per material; else "auto".
  const char *seams;
  // `abf_unwrap`: edges that are seams, each by its two vertices; null: none.
  const uint32_t *seam_vertices;
  // How many edges.
  size_t seam_count;
  // `abf_unwrap`: UVs that the mesh has, two numbers each; null: none.
  const float *uv;
  // How many: as many as there are vertices, unless there are `uv_indices`.
  size_t uv_count;
  // `abf_unwrap`: for every index of the mesh that of its UV; null: that of its vertex.
  const uint32_t *uv_indices;
  // `abf_unwrap`: a number for every triangle; null: none.
  const uint32_t *materials;
  // `abf_unwrap`: a number for every triangle; vertices in one place are joined within one object only; null: one object.
  const uint32_t *objects;
  // `abf_unwrap`: a number for every triangle; no seam runs between two of one polygon; null: no polygons.
  const uint32_t *polygons;
  // Relax the map, or each chart, until an energy is least: "abf" (angles), "isometric" (lengths), "usable" (angles, and areas
  // within bounds), or the weight of areas beside angles as a number; "usable" is 0.01. Null: no; `abf_relax`: "isometric".
  const char *energy;
  // `abf_flatten`, `abf_relax`: bring these vertices to given places, `pin_count` of them; null: none. One or two are met by
  // moving, turning and scaling the map, more by moving the others with `energy`, or "isometric".
  const uint32_t *pin_vertices;
  // As many places, u and v.
  const double *pin_uvs;
  // As many weights: a place with a weight above 0 need not be met; 0: it must. Null: all must.
  const double *pin_weights;
  // How many there are.
  size_t pin_count;
  // What becomes of a map that lies over itself: "off" leaves it, "split" parts it along the overlap, "deform" makes it anew
  // without overlaps, which takes many times as long. `abf_unwrap` parts charts in any case.
  const char *injective;
  // With "deform", how far parts of the boundary stay from each other, in units of the mesh.
  double boundary_gap;
} AbfOptions;

// What a result holds. Pointers are valid as long as the result.
typedef struct AbfView {
  // `sizeof(AbfView)`, set by the caller. Later versions append fields, and fill as much as the caller has.
  size_t size;
  // Vertices of the result. `abf_flatten`, and `abf_relax` without `uv_indices`: those of the input.
  size_t vertex_count;
  // `abf_flatten`, `abf_relax`: two numbers per vertex, u and v; else null.
  const double *uv64;
  // `abf_unwrap`: two numbers per vertex, u and v, in the unit square of its page; else null.
  const float *uv32;
  // `abf_unwrap`, and `abf_relax` with `uv_indices`: for each vertex the vertex of the input it is a copy of; else null.
  const uint32_t *remap;
  // Triangles, in the order of the input.
  size_t triangle_count;
  // The same: three vertices of the result per triangle; else null: they are those of the input.
  const uint32_t *indices;
  // `abf_unwrap`, `abf_relax`: the chart of each triangle, `UINT32_MAX` where it is in none; else null.
  const uint32_t *triangle_charts;
  // Charts.
  size_t chart_count;
  // `abf_unwrap`: the page of each chart; else null.
  const uint32_t *chart_pages;
  // `abf_unwrap`: pages; else 0.
  size_t page_count;
  // `abf_unwrap`: texels of a page along x; else 0.
  uint32_t width;
  // `abf_unwrap`: texels of a page along y; else 0.
  uint32_t height;
  // `abf_unwrap`: texels per unit of the mesh; else 0.
  double texels_per_unit;
  // `abf_unwrap`: the part of the pages that charts cover; else 0.
  double coverage;
  // Valid, and every solver ended as asked. Of an atlas: every chart is finished, and nothing lies over anything else, unless
  // `overlap` allows that.
  bool certified;
  // No triangle is flipped or collapsed, no interior vertex wound around twice. Proved with exact signs.
  bool valid;
  // Valid, and nothing lies over anything else.
  bool injective;
  // How the solver ended.
  enum AbfTermination termination;
  // Triangles that are turned over.
  size_t flips;
  // Triangles whose corners lie on one line.
  size_t collapsed;
  // Interior vertices that are wound around more than once.
  size_t wound;
  // Places where the map lies over itself.
  size_t overlaps;
  // `abf_unwrap`: charts that there was no time to finish; `abf_relax`: charts that could not be relaxed.
  size_t unfinished;
  // F / 3nt, the mean squared angle error, rad².
  double angle_error;
  // L² stretch, 1 for an isometry.
  double stretch_l2;
  // L∞ stretch.
  double stretch_linf;
  // Quasi-conformal distortion, the mean, 1 for a conformal map.
  double qc_mean;
  // The largest.
  double qc_max;
  // Area distortion, 0 where areas keep their proportions.
  double area_l2;
  // Area of the surface, in units of the mesh squared.
  double surface_area;
  // Area of the map, in UV units squared.
  double uv_area;
  // Whose result it is; "several" where charts differ; `abf_relax`: empty.
  const char *solver;
  // `abf_unwrap`: what was repaired, sentences separated by ", "; empty where nothing was.
  const char *repairs;
  // `abf_unwrap`: how many cuts were made for `coverage`.
  size_t parted_for_coverage;
  // `abf_unwrap`: how many cuts were made for `inner_margin`.
  size_t parted_for_margin;
  // How many steps `energy` took, all charts together; 0: none was asked for, or there was no map or no time.
  size_t relax_steps;
  // The energy before, for a surface of area 1; of several charts the mean by area. 0 without steps.
  double energy_before;
  // The same at the end.
  double energy_after;
  // Pins.
  size_t pin_count;
  // How far each pinned vertex is from its place, in units of the UVs, in the order of the options; else null.
  const double *pin_distances;
  // How many pins must be met and are not, of those that were tried: without any, `pin_count` is 0.
  size_t pins_missed;
} AbfView;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Flattens a disk: one UV per vertex.
//
// `positions` has three numbers per vertex, `indices` three vertices per triangle. `options` may be null. `*result` is a result
// to be freed by `abf_result_free`, or null where the status is not `ABF_STATUS_OK`.
enum AbfStatus abf_flatten(const double *positions,
                           size_t vertex_count,
                           const uint32_t *indices,
                           size_t index_count,
                           const struct AbfOptions *options,
                           struct AbfResult **result);

// Unwraps any mesh into an atlas: it is repaired, cut, flattened and packed. Vertices are split where seams run.
//
// `positions` has three numbers per vertex; `stride` is the distance from a vertex to the next in bytes, a multiple of 4; 0: 12.
// `indices` has three vertices per triangle. `options` may be null. `*result` is a result to be freed by `abf_result_free`, or
// null where the status is not `ABF_STATUS_OK`.
enum AbfStatus abf_unwrap(const float *positions,
                          size_t vertex_count,
                          size_t stride,
                          const uint32_t *indices,
                          size_t index_count,
                          const struct AbfOptions *options,
                          struct AbfResult **result);

// Relaxes a map that anybody made until an energy is least, each chart by itself, through valid maps only.
//
// `positions` and `indices` are those of `abf_flatten`. `uv` has two numbers per vertex, and `uv_count` is `vertex_count`; or it
// has `uv_count` UVs, and `uv_indices` for every index that of its UV. Of the options `energy`, pins, `time_limit`, `max_memory`,
// `normalize`, `zero_area`, `threads` and `progress` count. A chart that is not valid starts from Tutte's embedding, if it is a
// disk; else it stays. One that cannot be relaxed, as it is no manifold for example, stays, too, and counts as unfinished. The area
// of the whole map stays, and every chart keeps its centre: charts may come to lie over each other.
enum AbfStatus abf_relax(const double *positions,
                         size_t vertex_count,
                         const uint32_t *indices,
                         size_t index_count,
                         const double *uv,
                         size_t uv_count,
                         const uint32_t *uv_indices,
                         const struct AbfOptions *options,
                         struct AbfResult **result);

// Shows what a result holds. `view->size` must be `sizeof(AbfView)`.
enum AbfStatus abf_result_view(const struct AbfResult *result, struct AbfView *view);

// Frees a result. Null is fine.
void abf_result_free(struct AbfResult *result);

// Why the last call that failed on this thread did so. Valid until the next call on this thread.
const char *abf_last_error(void);

// The name of a status, such as "not-a-disk". Of a number that is no status: "unknown".
const char *abf_status_name(int32_t status);

// About how many bytes it takes at most to flatten a disk; what `max_memory` is compared with. Null stands for "auto".
// 0 means that there is no such solver.
uint64_t abf_predict_memory(const char *solver, size_t triangles, size_t vertices);

// The version of the library: 10000 major + 100 minor + patch.
uint32_t abf_version(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ABF_H */
