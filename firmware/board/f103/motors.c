/* Two motor drivers with a direction pin and a PWM pin each. */
#include "board.h"
#include "registers.h"
#include "robot.h"

#define DIR0 12
#define PWM0 13
#define PWM1 14
#define DIR1 15
#define PINS (BIT(DIR0) | BIT(PWM0) | BIT(PWM1) | BIT(DIR1))
#define MODE(pin, mode) ((uint32_t)(mode) << (4 * ((pin) - 8)))
#define LOWER_PINS 0x00004444u /* PB8 to PB11: floating inputs, as after reset */

void motors_off(void)
{
    GPIOB->BRR = PINS;
    GPIOB->CRH = LOWER_PINS | MODE(DIR0, PIN_OUT_SLOW) | MODE(PWM0, PIN_OUT_SLOW) | MODE(PWM1, PIN_OUT_SLOW)
                 | MODE(DIR1, PIN_OUT_SLOW);
}

void motors_start(void)
{
    motors_off();
    TIM1->ARR = PWM_FULL - 1;
    TIM1->CCR1 = 0;
    TIM1->CCR2 = 0;
    TIM1->CCMR1 = TIM_CCMR1_PWM_BOTH;
    TIM1->CCER = TIM_CCER_CC1NE | TIM_CCER_CC2NE; /* alone, a complementary output is not inverted */
    TIM1->EGR = TIM_EGR_UG;
    TIM1->BDTR = TIM_BDTR_MOE;
    TIM1->CR1 = TIM_CR1_CEN;
    GPIOB->CRH = LOWER_PINS | MODE(DIR0, PIN_OUT_SLOW) | MODE(PWM0, PIN_PERIPHERAL) | MODE(PWM1, PIN_PERIPHERAL)
                 | MODE(DIR1, PIN_OUT_SLOW);
}

static uint32_t duty(int16_t pwm)
{
    const int32_t size = pwm < 0 ? -(int32_t)pwm : pwm;
    return (uint32_t)(size > PWM_FULL ? PWM_FULL : size);
}

/* The pin to set, or in the upper half the one to reset, as BSRR takes it. */
static uint32_t direction(int16_t pwm, uint32_t pin)
{
    return pwm > 0 ? BIT(pin) : BIT(pin + 16);
}

void motors_set(const int16_t pwm[2])
{
    GPIOB->BSRR = direction(pwm[0], DIR0) | direction(pwm[1], DIR1);
    TIM1->CCR1 = duty(pwm[0]);
    TIM1->CCR2 = duty(pwm[1]);
}
