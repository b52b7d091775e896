/* The one thing that Rust can't write: a loop with OpenMP's pragmas. See ffi.rs, which calls it. */

#include <omp.h>
#include <stddef.h>

/* The numbers by which ffi.rs calls the schedules; OpenMP fixes them. */
_Static_assert(omp_sched_static == 1 && omp_sched_dynamic == 2 && omp_sched_guided == 3, "omp_sched_t");

/* Calls job(context, i) for each i below `jobs`, on a team of `threads` that the calling thread leads. A chunk of 0 means the schedule's
 * own size. Returns how large the team was; if that is less than `threads`, no job has been run. */
int pathmark_openmp_run(int schedule, int chunk, int threads, size_t jobs, void (*job)(const void *, size_t),
                        const void *context) {
  int team = 0;
  omp_set_dynamic(0);
  omp_set_schedule((omp_sched_t)schedule, chunk);
#pragma omp parallel num_threads(threads)
  {
    if (omp_get_thread_num() == 0) {
      team = omp_get_num_threads();
    }
    if (omp_get_num_threads() == threads) {
#pragma omp for schedule(runtime) nowait
      for (size_t index = 0; index < jobs; index++) {
        job(context, index);
      }
    }
  }
  return team;
}
