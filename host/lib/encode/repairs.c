#include "encode/repairs.h"

#include <math.h>

#include "encode/tunables.h"
#include "runtime/elementary.h"

/* Decibels that are lost on average, against packets of which all hold splats and none is lost: by the bytes that repair
 * packets take, and by losses that are more than they are. */
static double expected_loss(uint32_t all, uint32_t repairs, double loss) {
    const struct gscl_encode_tunables *t = &gscl_encode_tunables;
    double sum = t->packet_doubling * gscl_log2((double)all / (all - repairs));
    double probability = gscl_pow(1 - loss, all); /* that `lost` packets are */
    for (uint32_t lost = 0; lost < all; lost++) {
        if (lost > repairs)
            sum += probability * t->packet_all_lost * sqrt((double)lost / all);
        probability *= loss / (1 - loss) * (all - lost) / (lost + 1);
    }
    return sum + probability * t->packet_all_lost;
}

uint32_t gscl_choose_repairs(uint32_t all, double loss) {
    uint32_t most = 0;
    double least = INFINITY;
    for (uint32_t repairs = 0; loss > 0 && repairs < all; repairs++)
        least = fmin(expected_loss(all, repairs, loss), least);
    for (uint32_t repairs = 0; loss > 0 && repairs < all; repairs++)
        if (expected_loss(all, repairs, loss) <= least + gscl_encode_tunables.packet_reserve)
            most = repairs;
    return most;
}
