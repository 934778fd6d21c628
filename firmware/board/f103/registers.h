/* The registers of an STM32F103 that this board uses (reference manual RM0008), and no others. */
#ifndef REGISTERS_H
#define REGISTERS_H

#include <stdint.h>

#define BIT(n) (1u << (n))

typedef volatile uint32_t reg;

struct rcc { reg CR, CFGR, CIR, APB2RSTR, APB1RSTR, AHBENR, APB2ENR, APB1ENR, BDCR, CSR; };
struct flash { reg ACR; };
struct gpio { reg CRL, CRH, IDR, ODR, BSRR, BRR, LCKR; };
struct timer {
    reg CR1, CR2, SMCR, DIER, SR, EGR, CCMR1, CCMR2, CCER, CNT, PSC, ARR, RCR, CCR1, CCR2, CCR3, CCR4, BDTR;
};
struct usart { reg SR, DR, BRR, CR1, CR2, CR3; };
struct spi { reg CR1, CR2, SR, DR; };
struct dma_channel { reg CCR, CNDTR, CPAR, CMAR, reserved; };
struct dma { reg ISR, IFCR; struct dma_channel channel[7]; }; /* channel n of the manual is channel[n - 1] */
struct watchdog { reg KR, PR, RLR, SR; };
struct systick { reg CTRL, LOAD, VAL, CALIB; };

#define TIM2 ((struct timer *)0x40000000u)
#define IWDG ((struct watchdog *)0x40003000u)
#define GPIOA ((struct gpio *)0x40010800u)
#define GPIOB ((struct gpio *)0x40010C00u)
#define TIM1 ((struct timer *)0x40012C00u)
#define SPI1 ((struct spi *)0x40013000u)
#define USART1 ((struct usart *)0x40013800u)
#define DMA1 ((struct dma *)0x40020000u)
#define RCC ((struct rcc *)0x40021000u)
#define FLASH ((struct flash *)0x40022000u)
#define SYSTICK ((struct systick *)0xE000E010u)
#define NVIC_ISER ((reg *)0xE000E100u)
#define NVIC_IPR ((volatile uint8_t *)0xE000E400u)
#define SCB_SHPR ((volatile uint8_t *)0xE000ED18u) /* of exception 4 + index */

#define RCC_CR_HSEON BIT(16)
#define RCC_CR_HSERDY BIT(17)
#define RCC_CR_CSSON BIT(19)
#define RCC_CR_PLLON BIT(24)
#define RCC_CR_PLLRDY BIT(25)
#define RCC_CFGR_SW_PLL 2u
#define RCC_CFGR_SWS_MASK (3u << 2)
#define RCC_CFGR_SWS_PLL (2u << 2)
#define RCC_CFGR_PPRE1_2 (4u << 8) /* APB1 at half speed; its timers at full */
#define RCC_CFGR_PLLSRC_HSE BIT(16)
#define RCC_CFGR_PLLMUL(n) (((n) - 2u) << 18)
#define RCC_AHBENR_DMA1 BIT(0)
#define RCC_AHBENR_RESET (BIT(2) | BIT(4)) /* memories stay clocked in sleep */
#define RCC_APB2ENR_GPIOA BIT(2)
#define RCC_APB2ENR_GPIOB BIT(3)
#define RCC_APB2ENR_TIM1 BIT(11)
#define RCC_APB2ENR_SPI1 BIT(12)
#define RCC_APB2ENR_USART1 BIT(14)
#define RCC_APB1ENR_TIM2 BIT(0)
#define RCC_CSR_RMVF BIT(24)

#define FLASH_ACR_TWO_WAITS 2u
#define FLASH_ACR_PREFETCH BIT(4)

/* a pin's four bits in CRL or CRH */
#define PIN_OUT 0x3u       /* push-pull, 50 MHz */
#define PIN_OUT_SLOW 0x2u  /* push-pull, 2 MHz */
#define PIN_PERIPHERAL 0xBu
#define PIN_PULLED 0x8u    /* input; ODR says up or down */

#define TIM_CR1_CEN BIT(0)
#define TIM_EGR_UG BIT(0)
#define TIM_CCMR1_PWM_BOTH ((6u << 4) | (6u << 12)) /* PWM mode 1 on channels 1 and 2, taken over at once */
#define TIM_CCER_CC1NE BIT(2)
#define TIM_CCER_CC2NE BIT(6)
#define TIM_BDTR_MOE BIT(15)

#define USART_SR_NOT_KEPT (BIT(1) | BIT(2)) /* framing, noise */
#define USART_SR_ORE BIT(3)
#define USART_SR_RXNE BIT(5)
#define USART_CR1_RE BIT(2)
#define USART_CR1_TE BIT(3)
#define USART_CR1_RXNEIE BIT(5)
#define USART_CR1_UE BIT(13)
#define USART_CR3_DMAT BIT(7)

#define SPI_CR1_CPHA BIT(0)
#define SPI_CR1_MSTR BIT(2)
#define SPI_CR1_DIV16 (3u << 3)
#define SPI_CR1_SPE BIT(6)
#define SPI_CR1_SSI BIT(8)
#define SPI_CR1_SSM BIT(9)
#define SPI_CR1_DFF16 BIT(11)
#define SPI_SR_RXNE BIT(0)

#define DMA_CCR_EN BIT(0)
#define DMA_CCR_TCIE BIT(1)
#define DMA_CCR_FROM_MEMORY BIT(4)
#define DMA_CCR_MINC BIT(7)
#define DMA_CLEAR_CHANNEL4 (0xFu << 12)

#define IWDG_START 0xCCCCu
#define IWDG_UNLOCK 0x5555u
#define IWDG_KICK 0xAAAAu

#define SYSTICK_ON 7u /* enabled, with interrupt, from the core's clock */

#define IRQ_DMA1_CHANNEL4 14
#define IRQ_USART1 37

#endif
