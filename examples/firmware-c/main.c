/* Runs a part on bare metal: first its self-test, then once more as a controller would, a setpoint a period. */
#include "board.h"
#include "part.h"

/* A text with a number of 64 bits in hexadecimal. */
static void print_number(const char *text, uint64_t number)
{
    char digits[18];
    for (uint32_t place = 0u; place < 16u; place++) {
        digits[place] = "0123456789abcdef"[(number >> (60u - (4u * place))) & 15u];
    }
    digits[16] = '\n';
    digits[17] = '\0';
    print(text);
    print(digits);
}

/* The period: here an interrupt of a timer would be, which hands the position to the axes. */
static bool period(part_state *state, int64_t position[PART_AXES])
{
    part_setpoint setpoint;
    if (!part_step(state, &setpoint)) {
        return false;
    }
    part_position(&setpoint, position);
    return true;
}

int main(void)
{
    static part_state state;
    int64_t position[PART_AXES];
    uint64_t checksum = UINT64_C(0xcbf29ce484222325);
    uint32_t periods = 0u;
    const part_verdict verdict = part_self_test();
    print_number("verdict  ", (uint64_t)verdict);
    for (uint32_t section = 0u; section < PART_SECTIONS; section++) {
        part_start(&state, section);
        while (period(&state, position)) {
            checksum = part_checksum(checksum, position);
            periods++;
        }
    }
    print_number("periods  ", periods);
    print_number("checksum ", checksum);
    print_number("expected ", PART_CHECKSUM);
    return ((verdict == PART_GOOD) && (checksum == PART_CHECKSUM)) ? 0 : 1;
}
