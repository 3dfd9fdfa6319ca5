#pragma once

// Compensated joints of a mill, from a frozen compensation; C99:
//
//   #include <abbe/runtime/abbe_runtime.h>
//   #include <stdio.h>
//
//   int main(void) {
//     static unsigned char bytes[1 << 20];
//     FILE* file = fopen("mill.abbec", "rb"); // of: abbe compensate freeze ... -o mill.abbec
//     const size_t size = file ? fread(bytes, 1, sizeof bytes, file) : 0;
//     abbe_runtime* runtime = NULL;
//     abbe_runtime_state state;
//     const double nominal[3] = {600, 400, -100}; // mm: X Y Z, in the order of the chain
//     double joints[3], uncertainty_mm;
//     char text[ABBE_RUNTIME_TEXT];
//     if (file) fclose(file);
//     if (abbe_runtime_load(bytes, size, text, sizeof text, &runtime) != ABBE_OK) return puts(text), 1;
//
//     abbe_runtime_start(&state);
//     const int result = abbe_runtime_correct(runtime, &state, nominal, NULL, 1.0, joints);
//     printf("X %.4f Y %.4f Z %.4f mm: %s\n", joints[0], joints[1], joints[2], abbe_runtime_text(result));
//     if (abbe_runtime_uncertainty(runtime, nominal, NULL, &uncertainty_mm) == ABBE_OK)
//       printf("standard uncertainty of the correction %.1f um\n", 1e3 * uncertainty_mm);
//     abbe_runtime_free(runtime);
//     return result == ABBE_OK ? 0 : 1;
//   }
//
// It prints:
//
//   X 600.0341 Y 399.9836 Z -100.0124 mm: ok
//   standard uncertainty of the correction 1.7 um
//
// runtime holds what a controller runs, and what makes its file:
//   abbe_runtime.h                      the C interface: joints from points and from nominal joints, and back
//   abbe_runtime_states.h               compensation that depends on channels such as temperatures; C99
//   freeze.h                            C++: a machine and its errors compiled into a file, tried all over the travel

/* Compensation in real time: a C interface (C99 and later) over a frozen compensation, docs/runtime.md.
 *
 * The host reads the file and gives its bytes to abbe_runtime_load(), which allocates once. No other call allocates,
 * locks, touches files or throws; iterations are bounded. A handle is only read and may serve several threads, each
 * with its own state. Lengths are mm, angles rad. Arrays named joints and words have one entry per axis of the machine,
 * in chain order (workpiece to tool).
 */

/* The names and types of C. NOLINTBEGIN(modernize-*,readability-identifier-naming) */
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define ABBE_NOEXCEPT noexcept
extern "C" {
#else
#define ABBE_NOEXCEPT
#endif

enum {
  ABBE_RUNTIME_AXES = 16,       /**< no machine has more axes */
  ABBE_RUNTIME_FORMAT = 5,      /**< newest version of the file format; files that need less have 2 to 4 */
  ABBE_RUNTIME_ITERATIONS = 40, /**< no call takes more */
  ABBE_RUNTIME_TEXT = 64
};

/** Result of a call: negative, nothing was computed and the outputs are as they were; otherwise one of the first group
 *  plus flags. */
enum {
  ABBE_OK = 0,
  ABBE_ORIENTATION_LEFT = 1, /**< the point is exact; no turn of the rotary axes takes the orientation error away */
  ABBE_TURN_LIMITED = 2,     /**< the point is exact; near a singularity the turn is bounded, some orientation stays */
  ABBE_POSITION_LEFT = 3,    /**< the working axes do not reach the point, or only by too long a way */
  ABBE_RESULT_MASK = 0xff,
  ABBE_OUTSIDE_MAP = 0x100,    /**< errors are not known there: every axis keeps the errors of the end of its range */
  ABBE_OUTSIDE_TRAVEL = 0x200, /**< a joint lies beyond its travel; it is given as it is */
  ABBE_OUTSIDE_TOOL = 0x400,   /**< the tool is shorter or longer than the file was checked for */

  ABBE_NOT_FINITE = -1,       /**< an input is no number, or a length beyond 1e6 mm, an angle beyond 1e6 rad */
  ABBE_NOT_CONVERGED = -2,    /**< not solved within ABBE_RUNTIME_ITERATIONS */
  ABBE_NOT_POSSIBLE = -3,     /**< the machine has no three linear axes to take a point; abbe_runtime_correct() works */
  ABBE_SINGULAR = -4,         /**< the linear axes lie in one plane in this pose */
  ABBE_NULL = -5,             /**< a pointer is null */
  ABBE_NOT_STATED = -6,       /**< the errors that were frozen had no uncertainties */
  ABBE_STATES_NOT_GIVEN = -7, /**< errors depend on channels: use abbe_runtime_at_states(), abbe_runtime_states.h */
  ABBE_STALE = -8,            /**< stored states are too old, or from the future */

  ABBE_FILE_SHORT = -10,    /**< fewer bytes than a header, or than the header says */
  ABBE_FILE_FOREIGN = -11,  /**< no frozen compensation */
  ABBE_FILE_ORDER = -12,    /**< written by a computer of another byte order */
  ABBE_FILE_VERSION = -13,  /**< another version of the format */
  ABBE_FILE_CHECKSUM = -14, /**< damaged */
  ABBE_FILE_CONTENT = -15,  /**< the checksum is right, the content is not */
  ABBE_FILE_LONG = -16,     /**< more bytes than the header says */
  ABBE_FILE_NO_MEMORY = -17
};

typedef struct abbe_runtime abbe_runtime;

/** What one caller keeps between calls. Zero it (abbe_runtime_start) before the first one. It makes calls quicker; no
 *  result depends on it by more than rounding. */
typedef struct abbe_runtime_state {
  double correction[ABBE_RUNTIME_AXES]; /**< joints minus nominal joints of the last call, mm or rad */
  int iterations;                       /**< of the last call */
} abbe_runtime_state;

typedef struct abbe_runtime_axis {
  char letter;       /**< 'X' */
  int number;        /**< of "C2"; 0: none */
  int rotary;        /**< 0 linear, 1 rotary */
  int solved;        /**< 1: found from the point of the tool; 0: its word is its nominal joint */
  int endless;       /**< 1: no travel limits */
  double travel_min; /**< mm or rad */
  double travel_max;
  double map_min; /**< the errors are known from here, mm or rad */
  double map_max; /**< to here */
} abbe_runtime_axis;

typedef struct abbe_runtime_information {
  char machine[ABBE_RUNTIME_TEXT]; /**< its name, UTF-8, ends with 0 */
  char version[ABBE_RUNTIME_TEXT]; /**< of the program that wrote the file */
  uint64_t checksum;               /**< of the file */
  uint64_t source_checksum;        /**< of machine and errors */
  size_t bytes;                    /**< of the file */
  int axes;
  int tool_centre;              /**< 1: abbe_runtime_inverse() and _forward() work */
  double tool[3];               /**< mm, functional point from the gauge point, axes of the machine at zero */
  double tool_length_min;       /**< mm, against the tool direction */
  double tool_length_max;       /**< mm */
  double largest_correction_mm; /**< by how much the tool point is moved, over the poses tried when the file was made */
  double largest_correction_rad; /**< by how much the tool direction is turned there */
  double accuracy_mm;            /**< largest difference of the actual tool to where it should be, by all errors */
  double accuracy_rad;
  int worst_iterations;
  int has_uncertainty;           /**< 1: abbe_runtime_uncertainty() works */
  double largest_uncertainty_mm; /**< standard uncertainty of the correction of the point, over poses and tools */
  double mean_uncertainty_mm;    /**< the same, their mean */
  double uncertainty_lattice_mm; /**< largest difference of abbe_runtime_uncertainty() from the full model there */
} abbe_runtime_information;

/** Checks a file and prepares it. Allocates once; the bytes are not needed afterwards.
 *  @param text       null, or room for a sentence that says what is wrong (always ends with 0)
 *  @param text_size  bytes of it
 *  @param runtime    out: the handle, or null
 *  @return ABBE_OK or ABBE_FILE_... */
int abbe_runtime_load(const void* bytes, size_t size, char* text, size_t text_size,
                      abbe_runtime** runtime) ABBE_NOEXCEPT;
void abbe_runtime_free(abbe_runtime* runtime) ABBE_NOEXCEPT;

void abbe_runtime_describe(const abbe_runtime* runtime, abbe_runtime_information* information) ABBE_NOEXCEPT;
/** @return ABBE_OK, or ABBE_NULL for an axis that does not exist */
int abbe_runtime_describe_axis(const abbe_runtime* runtime, int axis, abbe_runtime_axis* description) ABBE_NOEXCEPT;
/** A result in words, with the gravest flag: "outside the map". */
const char* abbe_runtime_text(int result) ABBE_NOEXCEPT;

void abbe_runtime_start(abbe_runtime_state* state) ABBE_NOEXCEPT;

/** Tool centre to joints and back, without errors.
 *
 *  The world is the workpiece frame less the origin chosen when the file was made; `point` is the functional point in
 *  it (mm). `words` are the commands of the axes that are not solved from the point: rotary axes and further linear
 *  ones; entries of solved axes are not read, and written as their nominal joints.
 *  @param tool  functional point from the gauge point, mm, [3]; null: that of the file */
int abbe_runtime_nominal_inverse(const abbe_runtime* runtime, const double* point, const double* words,
                                 const double* tool, double* joints) ABBE_NOEXCEPT;
int abbe_runtime_nominal_forward(const abbe_runtime* runtime, const double* joints, const double* tool, double* point,
                                 double* words) ABBE_NOEXCEPT;

/** Joints at which the ACTUAL tool stands where the nominal machine has it at this pose, and the exact inverse.
 *  @param state   may be null
 *  @param enable  0 to 1: the part of all errors that is compensated; at 0 these are the nominal calls */
int abbe_runtime_inverse(const abbe_runtime* runtime, abbe_runtime_state* state, const double* point,
                         const double* words, const double* tool, double enable, double* joints) ABBE_NOEXCEPT;
int abbe_runtime_forward(const abbe_runtime* runtime, abbe_runtime_state* state, const double* joints,
                         const double* tool, double enable, double* point, double* words) ABBE_NOEXCEPT;

/** The same for a controller that plans in axis positions: nominal joints to compensated ones, and back. For every
 *  machine; joints and result may be the same array. */
int abbe_runtime_correct(const abbe_runtime* runtime, abbe_runtime_state* state, const double* nominal,
                         const double* tool, double enable, double* joints) ABBE_NOEXCEPT;
int abbe_runtime_uncorrect(const abbe_runtime* runtime, abbe_runtime_state* state, const double* joints,
                           const double* tool, double enable, double* nominal) ABBE_NOEXCEPT;

/** Standard uncertainty (GUM, one standard deviation) of the wholly enabled correction of the tool point at these
 * nominal joints (after abbe_runtime_inverse(): joints less state->correction), in the direction in which it is
 * largest; mm. It comes from the uncertainties of the errors that were frozen, linear between the nodes of a lattice
 * over axes and tool lengths; beyond its ends it is that of the end. ABBE_OUTSIDE_MAP, ABBE_OUTSIDE_TRAVEL and
 * ABBE_OUTSIDE_TOOL are raised as for a correction, also for axes and tools that the lattice leaves out. Takes no
 * iterations.
 *  @return ABBE_OK with flags, ABBE_NOT_STATED, ABBE_NOT_FINITE, ABBE_NULL */
int abbe_runtime_uncertainty(const abbe_runtime* runtime, const double* joints, const double* tool,
                             double* uncertainty_mm) ABBE_NOEXCEPT;

/** Tool vector of a controller's tool length offset (mm, world axes; G43 of a tool of length L along Z: 0, 0, L): the
 *  functional point lies at minus that from the gauge point. */
void abbe_runtime_tool_of_offset(const abbe_runtime* runtime, const double* offset, double* tool) ABBE_NOEXCEPT;

#ifdef __cplusplus
}
#endif
/* NOLINTEND(modernize-*,readability-identifier-naming) */
