#include "encode/repairs.h"

#include <math.h>

#include "encode/tunables.h"
#include "runtime/elementary.h"

/* What repair packets are expected to give. */
typedef struct outlook {
    double cost;    /* dB that are lost on average, against packets of which all hold splats and none is lost: by the
                       bytes that repair packets take, and by losses of more packets than they are */
    double failure; /* 0..1, the probability of such losses */
} outlook;

static outlook look_out(uint32_t all, uint32_t repairs, double loss) {
    const struct gscl_encode_tunables *t = &gscl_encode_tunables;
    outlook found = {t->packet_doubling * gscl_log2((double)all / (all - repairs)), 0};
    double probability = gscl_pow(1 - loss, all); /* that `lost` packets are */
    for (uint32_t lost = 0; lost <= all; lost++) {
        if (lost > repairs) {
            found.cost += probability * t->packet_all_lost * sqrt((double)lost / all);
            found.failure += probability;
        }
        probability *= loss / (1 - loss) * (all - lost) / (lost + 1);
    }
    return found;
}

static uint32_t cheapest(uint32_t all, double loss) {
    uint32_t best = 0;
    double least = INFINITY;
    for (uint32_t repairs = 0; repairs < all; repairs++) {
        const double cost = look_out(all, repairs, loss).cost;
        best = cost < least ? repairs : best;
        least = fmin(cost, least);
    }
    return best;
}

uint32_t gscl_choose_repairs(uint32_t all, double loss) {
    const struct gscl_encode_tunables *t = &gscl_encode_tunables;
    uint32_t repairs = loss > 0 ? cheapest(all, loss) : 0;
    const double most = look_out(all, repairs, loss).cost + t->packet_reserve;
    while (repairs + 1 < all && look_out(all, repairs, loss).failure > t->packet_failure &&
           look_out(all, repairs + 1, loss).cost <= most)
        repairs++;
    return repairs;
}
