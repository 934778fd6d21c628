/* The core as a shared library: whoever loads it plays the board. Its functions are the core's own; a robot is as many
 * bytes as robot_size says, what it keeps through a reset as kept_size. */
#include <stddef.h>

#include "robot_state.h"

size_t robot_size(void);
size_t kept_size(void);

size_t robot_size(void) {
    return sizeof(struct robot);
}

size_t kept_size(void) {
    return sizeof(struct kept);
}
