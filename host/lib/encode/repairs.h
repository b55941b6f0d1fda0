/* How many of a picture's packets are repair packets. */
#ifndef GSCL_LIB_REPAIRS_H
#define GSCL_LIB_REPAIRS_H

#include <stdint.h>

/* The number of repair packets, of `all` packets, where each packet is lost with the probability `loss`, 0..1, independently
 * of the others: that of the best expected quality or, so that it becomes rare that more are lost, a few more within the tunable
 * packet_reserve.  0 for a loss of 0. */
uint32_t gscl_choose_repairs(uint32_t all, double loss);

#endif
