/* The core as a shared library: whoever loads it plays the board. Its functions are the core's own; a robot is as many
 * bytes as robot_size says. */
#include <stddef.h>

#include "robot_state.h"

size_t robot_size(void);

size_t robot_size(void) {
    return sizeof(struct robot);
}
