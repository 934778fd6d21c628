/* The clock tree, the microsecond counter and the watchdog. */
#include "board.h"
#include "registers.h"

#define HSE_PATIENCE 5000 /* polls, over 2 ms; a crystal takes 2 ms at most, and the watchdog does not run yet */

uint32_t clock_start(void)
{
    RCC->CR |= RCC_CR_HSEON;
    uint32_t patience = HSE_PATIENCE;
    while (!(RCC->CR & RCC_CR_HSERDY) && --patience) {
    }
    const int crystal = (RCC->CR & RCC_CR_HSERDY) != 0;
    FLASH->ACR = FLASH_ACR_TWO_WAITS | FLASH_ACR_PREFETCH;
    /* 8 MHz * 9, or 8 MHz / 2 * 16 */
    RCC->CFGR = RCC_CFGR_PPRE1_2 | (crystal ? RCC_CFGR_PLLSRC_HSE | RCC_CFGR_PLLMUL(9u) : RCC_CFGR_PLLMUL(16u));
    RCC->CR |= RCC_CR_PLLON;
    while (!(RCC->CR & RCC_CR_PLLRDY)) {
    }
    RCC->CFGR |= RCC_CFGR_SW_PLL;
    while ((RCC->CFGR & RCC_CFGR_SWS_MASK) != RCC_CFGR_SWS_PLL) {
    }
    if (crystal)
        RCC->CR |= RCC_CR_CSSON;
    RCC->AHBENR = RCC_AHBENR_RESET | RCC_AHBENR_DMA1;
    RCC->APB2ENR = RCC_APB2ENR_GPIOA | RCC_APB2ENR_GPIOB | RCC_APB2ENR_TIM1 | RCC_APB2ENR_SPI1 | RCC_APB2ENR_USART1;
    RCC->APB1ENR = RCC_APB1ENR_TIM2;
    return crystal ? 72 : 64;
}

void watchdog_start(void)
{
    IWDG->KR = IWDG_START;
    IWDG->KR = IWDG_UNLOCK;
    IWDG->PR = 2; /* 40 kHz / 16 */
    IWDG->RLR = 50;
    while (IWDG->SR) {
    }
    watchdog_kick();
}

void watchdog_kick(void)
{
    IWDG->KR = IWDG_KICK;
}

void counter_start(uint32_t megahertz)
{
    TIM2->PSC = megahertz - 1;
    TIM2->ARR = 0xFFFF;
    TIM2->EGR = TIM_EGR_UG; /* takes over the prescaler */
    TIM2->CR1 = TIM_CR1_CEN;
}

uint16_t counter_now(void)
{
    return (uint16_t)TIM2->CNT;
}
