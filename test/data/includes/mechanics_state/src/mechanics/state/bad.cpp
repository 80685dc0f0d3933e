#include "mechanics/newton/free_border.h"
