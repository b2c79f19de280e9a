C     Isotropic elasticity whose text is in other files: one by the
C     preprocessor, one by INCLUDE, both beside this one.
#include "arguments.inc"
#define HALF_OF(x) ((x)/2.D0)
      INCLUDE 'declarations.inc'
      G = HALF_OF(PROPS(1)/(1.D0 + PROPS(2)))
      EL = 2.D0*G*PROPS(2)/(1.D0 - 2.D0*PROPS(2))
      DO I = 1, 3
        DO J = 1, 3
          DDSDDE(I, J) = EL
        END DO
        DDSDDE(I, I) = EL + 2.D0*G
        DDSDDE(I+3, I+3) = G
      END DO
      DO I = 1, NTENS
        DO J = 1, NTENS
          STRESS(I) = STRESS(I) + DDSDDE(I, J)*DSTRAN(J)
        END DO
      END DO
      RETURN
      END
