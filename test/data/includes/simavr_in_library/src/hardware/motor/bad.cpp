#include <simavr/sim_avr.h>
