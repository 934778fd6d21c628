/* The core as a shared library, so that Python's ctypes can drive it: what a board is to it, without hardware. */
#include <stdlib.h>

#include "robot.h"
#include "robot_state.h"

struct robot *library_create(uint32_t cause, uint32_t boots);
void library_destroy(struct robot *robot);
void library_restart(struct robot *robot, uint32_t cause, uint32_t boots);
void library_step(struct robot *robot, const struct robot_input *in, struct robot_output *out);

/* A robot that is started, or NULL without memory. */
struct robot *library_create(uint32_t cause, uint32_t boots)
{
    struct robot *robot = calloc(1, sizeof *robot);
    if (robot)
        robot_start(robot, cause, boots);
    return robot;
}

void library_destroy(struct robot *robot)
{
    free(robot);
}

void library_restart(struct robot *robot, uint32_t cause, uint32_t boots)
{
    robot_start(robot, cause, boots);
}

void library_step(struct robot *robot, const struct robot_input *in, struct robot_output *out)
{
    robot_step(robot, in, out);
}
