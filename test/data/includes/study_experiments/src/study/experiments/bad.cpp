#include "study/charts/speed_claims.h"
