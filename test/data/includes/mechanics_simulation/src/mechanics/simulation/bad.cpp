#include "mechanics/reduced/reduced_model.h"
