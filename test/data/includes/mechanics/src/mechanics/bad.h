#include "mechanics/body/gap.h"
